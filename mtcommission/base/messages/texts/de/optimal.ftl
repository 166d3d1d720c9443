# What was computed when an optimal control could not be found.
# $unit: of the signal or of the force, as the plant names it

signal-bound = |{ $signal }| <= { PLAIN($value, digits: 6) } { $unit }
value-about = { PLAIN($value, digits: 4) } { $unit }

bound-below-need = { $bound }, die Bewegung braucht mindestens { PLAIN($least, digits: 6) } { $unit }
bound-not-positive = { $bound }, die Bewegung braucht mehr als 0
bounds-near-least = { $bounds }: höchstens { PLAIN($within, digits: 1, unit: "%") } % vom Kleinstmöglichen entfernt
bounds-below-least = { $bounds }: kleinstmöglich ist etwa { $least }
bounds-beyond-time = { $bounds }: t_f wäre länger als { PLAIN($t_f) } s
bounds-need-longer = t_f = { PLAIN($t_f, digits: 6, unit: "ms") } ms ist zu kurz für { $bounds }: die zeitoptimale Steuerung unter denselben Schranken zeigt, wie lange sie brauchen

bounded-optimum-not-found = zeitoptimale Steuerung unter { $bounds } und { PLAIN($force, digits: 6) } { $unit }
optimum-too-long = eine optimale Steuerung von { PLAIN($t_f) } s sind { ROUND($radians, digits: 3) } rad des Schnellsten in der Maschine, gerechnet werden höchstens { ROUND($most, digits: 2) }
grid-search-stopped = die Suche nach t_f auf dem Gitter endete bei { PLAIN($t_f, digits: 6) } s
grid-program-unfinished = das lineare Programm mit { PLAIN($cells, digits: 9) } Zellen für { PLAIN($t_f, digits: 6) } s kam nicht zum Ende
free-motion-rings-on = die freie Bewegung nach dem Ende klingt zu langsam ab, um sie ganz zu verfolgen
band-program-gave-up = das lineare Programm des Optimums mit dem Band kam zu keinem Ende
band-exchange-goes-on = weitere Spitzen der freien Bewegung verlassen das Band, so viele auch gehalten werden

damping-not-solved = dämpfungsoptimale Steuerung für t_f = { PLAIN($t_f, digits: 6) } s und { PLAIN($force, digits: 6) } { $unit }: nur bis zu einer Grenze von { PLAIN($solved, digits: 6) } { $unit } gelöst

ipopt-ended = IPOPT endete mit { $status } nach { PLAIN($iterations, digits: 9) } Iterationen, Schema { $scheme }, { PLAIN($intervals, digits: 9) } Intervalle
ipopt-ended-at = t_f = { PLAIN($t_f, digits: 6) } s: { $ended }
ipopt-went-far = IPOPT ging bis t_f = { PLAIN($t_f) } s
target-not-reached = { PLAIN($reach, digits: 9) } des Ziels werden bei t_f = { PLAIN($t_f, digits: 9) } s erreicht

force-left = für die Bewegung bleiben { PLAIN($force, digits: 6) } { $unit }
modes-answer-alike = { PLAIN($force, digits: 6) } { $unit } beenden die Bewegung nach etwa { PLAIN($t_f, digits: 3) } s, { PLAIN($angle, digits: 2) } rad der langsamsten Eigenform; die Rundung lässt dann { PLAIN($doubt, digits: 1) } von t_f im Zweifel
no-control-reaches-rest = keine Steuerung für die Spanne { PLAIN($span, digits: 6) } nahe { PLAIN($t_f, digits: 9) } s kommt zur Ruhe
multipliers-prove-beyond = die Multiplikatoren beweisen eine Zeit jenseits von { PLAIN($t_f, digits: 3) } s
optimum-not-accurate = t_f = { PLAIN($t_f, digits: 9) } s mit { PLAIN($switches, digits: 9) } Umschaltungen, relative Lücke { PLAIN($gap, digits: 2) } (höchstens { PLAIN($allowed_gap, digits: 6) }), Endfehler von { $state } { PLAIN($error, digits: 2) } seines Höchstwerts (höchstens { PLAIN($allowed_error, digits: 6) })
