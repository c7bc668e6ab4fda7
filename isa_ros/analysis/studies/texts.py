"""
Texts on the figures of the studies, for `studies.Study.seen`.

Numbers in braces are results of the run that writes the page.
"""

ADC_BITS = """\
From 10 bits up only the ripple changes. Coarser, the loops hunt by half a code of the force
sensor: {smart_manifold[8].ripple_mid:.2g} Nm at 8 bits, {smart_manifold[12].ripple_mid:.2g} Nm
as shipped, and {isa_v5[8].ripple_mid:.2g} N at 8 bits in the ISA v5, whose sensor spans 20 kN."""
ENCODER = """\
Standing on the wheel, the ripple grows with the count: the damping of the impedance and the
velocity compensation turn every count into force. Ten times coarser it is
{isa_v5[10].ripple_wheel:.2g} N in the ISA v5, a hundred times {isa_v5[100].ripple_wheel:.3g} N.
Blocked, only the manifold hunts, a hundred times coarser: by {smart_manifold[69].ripple_mid:.2g}
Nm at {smart_manifold[69].ripple_hz:.0f} Hz, through the velocity compensation; without that it
does not."""
FORCE_RATE = """\
At 1 kHz neither actuator hunts. The manifold overshoots by {smart_manifold[1000].overshoot:.0f}
instead of {smart_manifold[5000].overshoot:.0f} %, its ripple near the stop grows from
{smart_manifold[5000].ripple_end:.2g} to {smart_manifold[1000].ripple_end:.2g} Nm, and -3 dB
moves up: the delay takes damping away. From 2 kHz on hardly anything changes."""
POSITION_RATE = """\
The trot needs the rate: at 100 Hz the error is {smart_manifold[100].force_error:.2g} instead of
{smart_manifold[1000].force_error:.2g} Nm, and {isa_v5[100].force_error:.0f} instead of
{isa_v5[1000].force_error:.0f} N. Blocked, only the slower speed estimate has an effect:
{smart_manifold[100].bandwidth:.0f} instead of {smart_manifold[1000].bandwidth:.0f} Hz."""
CURRENT_RATE = """\
The manifold is not affected. The ISA v5 has a long shoulder close to -3 dB, its spool loop
around the coil being faster than equation 8; at 5 kHz it lies below: -3 dB falls from
{isa_v5[10000].bandwidth:.0f} to {isa_v5[5000].bandwidth:.0f} Hz, while rise and overshoot hardly
change."""
DELAY = """\
Delays within a period of the current block have no effect: overshoot stays at
{smart_manifold[0].overshoot:.0f} and {isa_v5[0].overshoot:.0f} %, and nothing hunts."""
LAP = """\
Overlap does not hunt, even at 40 um, where the ISA v5 creeps for a second or two; it slows:
with 20 um -3 dB falls from {smart_manifold[0].bandwidth:.0f} to
{smart_manifold[20].bandwidth:.0f} Hz in the manifold, and the error in the trot grows from
{smart_manifold[0].force_error:.2g} to {smart_manifold[20].force_error:.2g} Nm.
Underlap hunts, for at null two lands are open at once: with 5 um the manifold on its wheel by
{smart_manifold[-5].ripple_wheel:.2g} Nm at {smart_manifold[-5].ripple_hz:.0f} Hz, which half
the gain K_p would stop. The ISA v5 swings on its mass by {isa_v5[-5].ripple_wheel:.2g} N at
{isa_v5[-5].ripple_hz:.2g} Hz with 5 um and by {isa_v5[-20].ripple_wheel:.0f} N with 20 um: the
velocity compensation is now too large, and without it almost no swing is left."""
BACKLASH = """\
Under load the play is taken up, and the step overshoots more: by
{smart_manifold[5].overshoot:.0f} % with 5 mrad of half play in the manifold, by
{isa_v5[200].overshoot:.0f} % with 200 um in the ISA v5. Neither hunts across it, back at zero
torque either: the ripple stays below {smart_manifold[5].ripple_end:.1g} Nm. -3 dB falls from
{smart_manifold[0].bandwidth:.0f} to {smart_manifold[5].bandwidth:.0f} and from
{isa_v5[0].bandwidth:.0f} to {isa_v5[200].bandwidth:.0f} Hz. The trot is not affected."""
FRICTION = """\
The sensor is on the load's side of the friction, which the force loop therefore compensates: ten
times the shipped friction hardly changes the step ({smart_manifold[20].rise:.2g} instead of
{smart_manifold[2].rise:.2g} ms) and raises the error in the trot from
{smart_manifold[2].force_error:.2g} to {smart_manifold[20].force_error:.2g} Nm and from
{isa_v5[100].force_error:.0f} to {isa_v5[1000].force_error:.0f} N."""
SENSOR_STIFFNESS = """\
A softer sensor reduces bandwidth and damping: at a tenth of the shipped stiffness the manifold
falls from {smart_manifold[20].bandwidth:.0f} to {smart_manifold[2].bandwidth:.0f} Hz and
overshoots by {smart_manifold[2].overshoot:.0f} %. A stiffer one gains nothing, and near the
stop, where the oil is stiff too, the manifold hunts at 100 kNm/rad, by
{smart_manifold[100].ripple_end:.2g} Nm at {smart_manifold[100].ripple_hz:.0f} Hz."""
SUPPORT = """\
A soft bench acts like a soft sensor: {smart_manifold[2].bandwidth:.0f} instead of
{smart_manifold[50].bandwidth:.0f} Hz at 2 kNm/rad. Near the stop the manifold then hunts, by
{smart_manifold[10].ripple_end:.2g} Nm at {smart_manifold[10].ripple_hz:.0f} Hz with 10 kNm/rad:
the inertia of the fixture swings between sensor and bench; with half of it the loop is quiet.
The ISA v5 rings there for seconds at {isa_v5[1].ripple_hz:.3g} Hz with 1 N/um, because its
gains are scheduled for a rigid stop; with constant gains it does not."""
