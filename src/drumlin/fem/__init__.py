"""The finite-element model: plane stress, with linings in unilateral frictional contact.

A brake passes the rooms from the bottom to the top. `mesh` and `hp` divide it into elements,
`substructure` condenses its bodies, `preparation` collects them as a prepared model, and
`equilibrium` poses the contact problem of its shoes. `model` solves that problem and answers with a
response; `solve` repeats this on finer divisions until `error_control` accepts the answer.
`analysis` asks a solved brake for more than its response. `width` multiplies the elements of a
section by polynomials across the width of the shoe. `solid` solves shoes of finite width, by
`width` or by hexahedra.
"""
