decimal-mark = .

# Quantities with units, as people type them.

# Kinds of quantity, with their article.

# $what: a kind of quantity; $units: one of the next three
quantity-expected = must be in { $units }

# What is wrong with a unit.
unit-unreadable = "{ $unit }" is not a unit; write it like "N s/m" or "m/s^2"
unit-unknown = unknown unit "{ $unit }"
# $worth: e.g. 1 lb = 0.45359237 kg
unit-worth = {" "}({ $worth })
unit-meant = {" "}(did you mean "{ $unit }"?)

# What is wrong with a quantity; $advice is empty, unit-worth or unit-meant, $hint empty or g-is-the-gram.
quantity-too-long = got "{ $got }"; a quantity has at most { $most } characters
quantity-without-unit = got "{ $got }": { $why }{ $advice }; { $expected }
g-is-the-gram = { " " }(g is the gram here, write 9.81 m/s^2)
quantity-without-number = got "{ $got }", which does not begin with a number; { $expected }
number-with-separators = got "{ $got }"; write the number without thousands separators
number-with-comma = got "{ $got }" with a comma; write it with a point: "{ $wanted }"

# What a force is called on a rotary axis, and on an open-loop axis, whose motor is driven by its acceleration; what a mass is called.
word-force = { $axis ->
    [open-loop] acceleration
    [rotary] torque
   *[linear] force
}
word-force-first = { $axis ->
    [open-loop] Acceleration
    [rotary] Torque
   *[linear] Force
}
word-a-force = { $axis ->
    [open-loop] an acceleration
    [rotary] a torque
   *[linear] a force
}
word-a-force-first = { $axis ->
    [open-loop] An acceleration
    [rotary] A torque
   *[linear] A force
}
# As a first and a last part of a German word.
word-force-before = { word-force }
word-force-behind = { word-force }
word-mass = { $axis ->
    [rotary] moment of inertia
   *[linear] mass
}
word-f-max = { $axis ->
    [open-loop] a_max
   *[other] F_max
}
word-f-set = { $axis ->
    [open-loop] a_set
   *[other] F_set
}
word-lambda = { $axis ->
    [open-loop] lambda B
   *[other] lambda_F
}
word-max-force = { $axis ->
    [open-loop] max_acceleration
   *[other] max_force
}
ratio-expected = must be without a unit, or in { $units }
quantity-in-other = got "{ $got }"{ $advice }; { $expected }
