// The source's own shots as jobs: what the built-in table and the tests start from.
#pragma once

#include <impactdic/impact_model.h>

namespace impactdic::sim::job {

// Chapter 3, a tennis ball on the string-bed: m 56.7 g, D 67 mm, k 13385 N/m, b 5.36 N s/m, dropped
// at 2 m/s on 15 degrees. Friction 0.0335 (Eq. 3.12 of the measured 15 degree shot).
ImpactJob racket_job();
// Chapter 4, a lacrosse ball on wood with the published rule: m 145.66 g, D 63.25 mm,
// k 875000 N/m^1.5, b 9.5, mu_k 0.54, mu_s 0.74; 20 degrees, (0.57, -1.69) m/s.
ImpactJob wood_published_job();
// The same ball by Maw, Barber and Fawcett, nu 0.49, b 18. It was dropped vertically, so with a
// positive tangential velocity the surface falls to the right: -20 degrees.
ImpactJob wood_sound_job();
// Kharaz, Gorham and Salman (2001): 5 mm of alumina (380 GPa, 0.23, 4000 kg/m^3) on glass (70 GPa,
// 0.25) at 3.9 m/s, that many degrees from the normal; friction 0.092, restitution 0.98. By partial
// slip under tsuji, weightless.
ImpactJob alumina_job(double incidence_deg);

}  // namespace impactdic::sim::job
