# Names of states, outputs and keys of the profile.

# The name of a key of the profile: the catalogue finds it below.
name = { $key }

name-F-set = Set { word-force } { word-f-set }
name-F = { word-force-first } F
name-tcp = Tool centre point
name-tcp-vibration = Elastic deflection at the tool
name-x-b = Base position x_b
name-x-s = Slider position x_s
name-phi = Tower rotation φ
name-v-b = Base velocity v_b
name-v-s = Slider velocity v_s
name-v-phi = Tower rotation rate v_φ
name-x = Position x
name-v = Velocity v
name-t-f-lower-bound = Proven lower bound of t_f
name-relative-gap = Relative gap to the lower bound
name-switching-law-holds = Switching law holds on the whole interval
name-law-residual = Largest deviation from the control law, relative to { word-f-max }
name-tcp-deviation = Permitted TCP deviation (band)
name-tcp-gain = Gain at the tool
name-measured-gain = Gain at the encoder
name-tcp-height = TCP height h, signed
name-force-lag = Time constant of the { word-force } loop T
name-Kv = Position gain Kv
name-Kp = Velocity gain Kp
name-Tn = Integral time Tn
name-encoder = Encoder
name-kind = Kind of control
name-reserve = Reserve
name-position-loop = Place of the position loop
name-lead = Travel per turn of the screw
name-encoder-resolution = Resolution of the encoder
name-contour-deviation = Permitted contour deviation
name-contour-feed = Largest feed for that
name-band = Reserve: usable share of the band
name-force = Reserve: usable share of the { word-force }
name-base-mass = Base { word-mass }
name-slider-mass = Slider { word-mass }
name-rotary-inertia = Rotary inertia
name-lever-arm = Lever arm
name-base-stiffness = Base stiffness
name-base-damping = Base damping
name-rotary-stiffness = Rotary stiffness
name-rotary-damping = Rotary damping
name-moving-mass = Moving { word-mass }
name-frequency = Frequency
name-damping-ratio = Damping ratio
name-max-acceleration = Max acceleration of the motor
name-position-cycle = Position cycle
name-velocity-cycle = Velocity cycle
name-drive-kind = Kind of drive
name-max-force = Max { word-force }
name-continuous-force = Continuous { word-force }
name-static-load = Static load
name-coulomb-friction = Coulomb friction
name-viscous-friction = Viscous friction
name-velocity-step = Velocity step
name-distance = { $axis ->
    [rotary] Angle
   *[linear] Distance
}
name-max-velocity = Max velocity
name-dwell = Dwell
name-max-settling-time = Max settling time
name-frequency-spread = Frequency spread
name-damping-spread = Damping spread
name-payload-radius = Radius of gyration of the payload
name-surface = Band for surfaces
name-accuracy = Band for accuracy
name-speed = Band for speed
name-payload-least = Payload (least)
name-payload-largest = Payload (largest)

## $mode: as the profile names it

mode-deflection = Deflection of mode { $mode }
mode-rate = Rate of mode { $mode }
