// Scenarios to begin with.
"use strict";

const CONTACTS = `[contacts]
count = 2000
stiffness = 0.0005                                   # N_c <k> = 1
thresholds.gaussian = { mean = 1.0, std = 0.15 }     # P_c
reforming.point = { at = 0.0 }                       # R
`;

/** @type {Record<string, string>} */
const EXAMPLES = {
  "Stick-slip": `# Contacts that stretch with the slider, break and form again.

${CONTACTS}
[initial]
point = { at = 0.0 }                                 # Q_ini

[block]
stiffness = 0.4                                      # K
slip = "overdamped"

[drive]
distance = 12.0
points = 1001
`,
  "Friction against velocity": `# Thermally activated breaking: friction grows with the logarithm of the velocity.

${CONTACTS}
[contacts.temperature]
energy = 2.5e-5                                      # T, a tenth of the barrier
attempt_rate = 1.0
barrier = "elastic"

[velocity_curve]
from = 1e-6
to = 10.0
points = 21
`,
  "Velocity step": `# Ageing: the slower the slider, the older and stronger its contacts.

${CONTACTS}
[contacts.ageing.logarithmic]
growth = 0.04
time = 1.0

[[protocol]]
velocity = 0.01
distance = 5.0
start = "steady"

[[protocol]]
velocity = 0.1
distance = 5.0
`,
  "Static friction against hold time": `# Healing: contacts that age while the slider is held.

${CONTACTS}
[contacts.ageing.logarithmic]
growth = 0.04
time = 1.0

[hold_curve]
from = 0.1
to = 1000.0
points = 9
velocity = 0.1
`,
};
