# Reading a record.
# $keys: in the JSON; $constant: what stands for a number; $given, $read: versions of the schema

record-not-readable = not a record of mtcommission run: { $why }
record-without-profile = a record holds the text of the profile, and this machine was not run from one; run the profile's file
record-steers = holds characters that steer a terminal, which no run writes; run the profile again
record-not-json = not a record of mtcommission run: its contents are not JSON; give the record.json that mtcommission run writes
record-is-directory = is a directory; give the record.json in it
record-lacks-keys = not a record of mtcommission run: { $keys } missing
record-of-other-schema = record schema { $given }, this version reads { $read }; run the profile again, or print it with the version that wrote it
record-edited = its contents are not those that mtcommission run wrote: it was edited or damaged; change the profile instead, and run it again
record-of-other-version = another version of mtcommission wrote it; run the profile again, or use that version
record-both = { $first }; { $then }
json-no-number = { $constant } is no number of JSON
json-array = an array
json-boolean = true or false
json-whole-number = a whole number

# What is assumed beyond the profile.

assumed-illustrative = the profile's illustrative values
assumption-illustrative = The machine data are illustrative, not those of a real machine.
assumption-linear = { $axis ->
    [rotary] The axis is taken as a linear system: a rigid body, a first-order torque lag and decoupled flexible modes. Friction, backlash, cogging and cable drag are left out.
   *[linear] The axis is linear: a rigid mass, a first-order { word-force } lag and decoupled flexible modes. Friction, backlash, cogging and cable forces are left out.
}
assumption-encoder = Velocity is the difference of the encoder position over one velocity cycle, as drives form it; beyond a stated resolution the encoder measures without error.
assumption-cycles = Position controller and feed-forward act one position cycle late and are held for one cycle; the { word-force } acts one velocity cycle late.
assumption-static-load = The static load takes its amount from the { word-force } available for motion; its deflection is constant and taken up by the integral part of the velocity loop.

# Where a datum comes from.

source-default = default
source-stated = stated in the profile
source-illustrative = illustrative
source-accepted-default = default accepted, not measured
source-measured = measured, { $date }

# Paths of the loop, each with what delays it.

path-position-setpoint = position setpoint
path-position-controller = position controller
path-wanted-state = wanted state
path-velocity-controller = velocity controller

# Friction
assumption-linear-with-friction = { $axis ->
    [rotary] The search for the limits is linear: a rigid body, a first-order torque lag and decoupled flexible modes; Coulomb friction is taken off the torque that is left. The recommended limits were simulated once more with the stated friction. Backlash, cogging and cable drag are left out.
   *[linear] The search for the limits is linear: a rigid mass, a first-order { word-force } lag and decoupled flexible modes; Coulomb friction is taken off the { word-force } that is left. The recommended limits were simulated once more with the stated friction. Backlash, cogging and cable forces are left out.
}
friction-kept = Move { $move } with Coulomb friction of { FORCE($coulomb) } and viscous friction of { DAMPING($viscous) }: settling time { TIME($settling) } (without: { TIME($without) }), residual deviation { LENGTH($residual) }, largest set { word-force } { FORCE($force) }; all that was looked at is kept (worst corner).
friction-broken = Move { $move } with Coulomb friction of { FORCE($coulomb) } and viscous friction of { DAMPING($viscous) }: settling time { TIME($settling) } (without: { TIME($without) }), residual deviation { LENGTH($residual) }, largest set { word-force } { FORCE($force) }; this breaks band, settling time or { word-force } (worst corner). A settling time of – is: not settled a second after the setpoint. Raise the integral gain, add friction compensation in the control, or ask for a wider band.
