// Which dot is which on a square grid of which a part may be seen.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/camera/calibrate/board.h"

namespace impactdic::camera {

// `centres`: of what may be dots, px. Dots are numbered along their rows from one to the next, each
// looked for where the step before it leads to; what lies off the grid is left out. All dots look
// alike: of a part of the target the first row and column that are seen are taken for the target's
// own, and rows for those that run most along the picture's. That moves the target's origin, not
// the plane. Nothing where fewer than 3 rows or columns are found, or more than there are.
std::vector<Sighting> number_dots(const std::vector<Eigen::Vector2d>& centres, int columns,
                                  int rows);

}  // namespace impactdic::camera
