"""Several tables together: which causes they share, with which sizes.

``source``
    The tables, and the rows of one file divided by a column.
``shared_forms``, ``likelihood``, ``table``
    What one table says about the sizes of a set of causes, whatever their prior is.
``hierarchy``, ``search``
    The evidence of the sets of causes that all tables may share, with sizes that may vary between tables.
``choice``, ``transfer``, ``models``
    Which shared causes are claimed, what they gain on tables left out, and their sizes.
``pool``, ``engine``, ``result``, ``explain``
    The stages in order, and what a user gets.
"""
