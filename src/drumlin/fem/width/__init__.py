"""Shoes with a finite width: hp elements in the section times polynomials across the width.

The section is the x-y plane of the brake, and z is the distance from the mid-plane of a shoe. The
displacements are sums of products of the section's shape functions psi_a and functions of z,

    u_x, u_y = sum psi_a(x, y) e_k(z),   e_k even,
    u_z      = sum psi_a(x, y) o_k(z),   o_k odd.

All polynomials of z up to a degree q give the model of degree q. The model of degree q = 0 with the
elastic constants of plane stress is plane stress itself. Models of a higher degree follow from a
shoe that is divided into hp elements. The package computes the substructures of the shoe, which
enter contact, equilibrium and response like substructures of plane stress. It also estimates the
error of plane stress, and corrects answers of plane stress for the widths of the shoes (hierarchic
plate models: Szabo & Babuska, Introduction to Finite Element Analysis, ch. 13; Duester, Broeker &
Rank 2001).

Each row of nodes has all functions of z of its part. Fewer functions in rows far from bonds and
free sides would save few unknowns. On the second level with degree 3, 14 to 19 % of the unknowns on
a line through the thickness belong to the rows of the web, on four random brakes whose linings
overhang their webs ("built" 510003 and 510011, "free" 510000 and 510013 of
`drumlin_studies.solid_error`). All other rows belong to linings and tables, which have bonds or
free sides no farther away than their thickness. This share is counted from the divisions; rows with
fewer functions were not solved.
"""
