"""What the program says, as data: kinds with typed values; one text per language and axis kind.

message.py      a kind and its values: what results and records hold
quantities.py   SI values -> numbers with an engineering unit
functions.py    what the texts call to print them
formula.py      formulas as trees
catalogue.py    message -> text of a language, at the rim only
texts/          the texts, in Fluent's format: ``texts/LANGUAGE/*.ftl``
"""
