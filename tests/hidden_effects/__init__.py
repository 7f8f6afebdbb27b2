"""Tables with a planted cause, made by physics that the engine does not know, and their judge.

`designs` says where is measured, `gas`, `echo`, `thermometer` and `disturbance` what nature does,
`causes` plants one cause a function, `unknown` what is outside the catalogue. `cases` makes a table
of a `Spec`, `menu` draws specs, `answers` asks the engine, `targets` and `score` judge. To hide a
further cause, write one function under `causes` with the decorator `cause`.
"""
