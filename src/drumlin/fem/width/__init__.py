"""Shoes with a finite width: hp elements in the section times polynomials across the width.

z is the distance from the mid-plane of a shoe. The section is the cut of the shoe by its mid-plane,
which is the x-y plane. The displacements are sums of products of the section's shape functions
psi_a and functions of z,

    u_x, u_y = sum psi_a(x, y) e_k(z),   e_k even,
    u_z      = sum psi_a(x, y) o_k(z),   o_k odd.

All polynomials of z up to a degree q give the model of degree q. The model of degree q = 0 with the
elastic constants of plane stress is plane stress itself. The package divides the section into hp
elements and computes the substructure of a shoe with its width. This substructure enters contact,
equilibrium and response like a substructure of plane stress. The package also estimates the error
of plane stress, and corrects answers of plane stress for the widths of the shoes (hierarchic plate
models: Szabo & Babuska, Introduction to Finite Element Analysis, ch. 13; Duester, Broeker & Rank
2001).

A row of nodes runs along the shoe, at one depth. Each row has all functions of z of its part. Fewer
functions in rows far from bonds and free sides would save few unknowns: only the rows of the web
are far enough. On the second level with degree 3 they have 14 to 19 % of the unknowns on a line
through the thickness. This was counted on four random brakes whose linings overhang their webs
("built" 510003 and 510011, "free" 510000 and 510013 of `drumlin_studies.solid_error`). Rows with
fewer functions were not solved.
"""
