# What a kind of plant assumes beyond the profile.

# $side: above or below, the place of the tool
tcp-height-assumed = tcp_height is taken as the height of the tool centre point { $side ->
    [above] above
   *[below] below
} the rotary joint, so the tool stands at x_s - x_b + h phi as seen from the base; the paper names h but gives no equation and no sign.
