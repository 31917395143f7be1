"""The finite-element model: plane stress, with linings in unilateral frictional contact.

A solve uses the packages in this order. `mesh` and `hp` divide the brake into elements,
`substructure` condenses its bodies to the contact nodes, `preparation` collects the condensed
bodies as a prepared model, and `equilibrium` poses the contact problem of the shoes. The module
`model` solves this problem and returns a response. `solve` repeats the work on finer divisions
until `error_control` accepts the response.

`analysis` computes more than the response, such as stresses, holding and sensitivities. `width`
multiplies the elements of a cross-section by polynomials across the width of the shoe. `solid`
solves shoes of finite width by the model of `width`.
"""
