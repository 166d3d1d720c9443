# What a kind of plant assumes beyond the profile.

# $side: above or below, the place of the tool
tcp-height-assumed = tcp_height: the tool stands { $side ->
    [above] above
   *[below] below
} the rotary joint, at x_s - x_b + h φ; the paper names h without equation or sign

# What does not fit together in the data of a plant.

damping-ratio-beyond-one = got { $got }, must be >= 0 and < 1
# $frequency [Hz]
modes-at-one-frequency = modes { $one } and { $other } at { PLAIN($frequency, digits: 6) } Hz
# $modes: modes-at-one-frequency
equal-poles = { $modes }: { modes-have-equal-poles }
mode-not-driven = mode { $mode } is not driven by the { word-force } (lever arm 0)
state-mode-unknown = names none of the modes of [plant], must be { $names }
lever-arm-zero = got 0, but the { word-force } must turn the tower; give the arm, or describe the axis as kind = "modal"
# $got, $most: in $unit
damping-beyond-critical = got { $got }, a damping ratio of { PLAIN($ratio, digits: 3) }; must be < { PLAIN($most, digits: 4) } { $unit } (ratio 1)
named-twice = got "{ $name }" twice, names must differ
