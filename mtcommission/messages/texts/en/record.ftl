# Reading a record.
# $key, $keys: where in the JSON; $given, $read: versions of the schema; $got: what stands there

record-not-readable = not a record of mtcommission run: { $why }
record-lacks-keys = not a record of mtcommission run: { $keys } missing
record-of-earlier-schema = record schema { $given } was written by an earlier version, this one reads { $read }; run the profile again
record-of-other-schema = record schema { $given }, this version reads { $read }; run the profile again, or print it with the version that wrote it
record-edited = its contents are not those that mtcommission run wrote: it was edited or damaged; change the profile instead, and run it again
record-edited-where = its contents are not those that mtcommission run wrote: it was edited or damaged; { $wrong }; change the profile instead, and run it again
record-of-other-version = another version of mtcommission wrote it; run the profile again, or use that version
record-of-other-version-where = another version of mtcommission wrote it; { $wrong }; run the profile again, or use that version
record-both = { $first }; { $then }
record-has-more-wrong = and more
record-wrong-at = { $key }: { $fault }
record-got = got { $got }, expected { $expected }
record-missing = missing
record-of-no-known-form = of no form that is known here
json-object = an object
json-array = an array
json-text = a text
json-boolean = true or false
json-number = a number
json-number-or-null = a number or null
json-number-or-text = a number or a text
json-whole-number = a whole number
