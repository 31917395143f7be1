"""The hierarchic model of the width: the section's hp elements times polynomials across the width.

The displacements are sums of products of the section's shape functions and functions of z,

    u_x, u_y = sum psi_a(x, y) e_k(z),   e_k even,
    u_z      = sum psi_a(x, y) o_k(z),   o_k odd.

All polynomials up to a degree q make the model of degree q; q = 0 with the constants of plane
stress is plane stress itself. A divided shoe and a degree come in. Substructures that contact,
equilibrium and response take like those of plane stress go out, and the error of plane stress.
(Szabo & Babuska, Introduction to Finite Element Analysis, ch. 13; Duester, Broeker & Rank 2001.)
"""
