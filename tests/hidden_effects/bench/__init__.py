"""The third world: tables that come only from the virtual bench, and their judge.

`world` makes a table of a `Spec` and its pair without the cause, `strength` says how visible a cause
is, `truth` what may be said about a table, `influence` which causes a table cannot tell apart, `menu`
draws specs, `answers` asks the engine, `gains` corrects a campaign that the engine never saw,
`summary` counts.
"""
