// SPDX-License-Identifier: Apache-2.0
// The table of a surface's directional-hemispherical reflectance against mu, the cosine of incidence: what the device
// reads where light is absorbed. Nodes stand as close as the surface needs: every row of brdf.def over its whole range
// of keys, from a sharp lobe at grazing incidence to a step in a measured table.
#pragma once

#include <functional>
#include <vector>

namespace clray {

/// Linear interpolation between the nodes stays within this of the function.
constexpr double kReflectanceError = 2e-5;

/// `reflectance(mu)` for 0 < mu <= 1 as a table: the number of nodes, their mu (ascending, 0 to 1), their values.
/// `theta_rad`: angles of incidence where the function may bend or step; each becomes a node.
std::vector<double> reflectance_table(const std::function<double(double)>& reflectance,
                                      const std::vector<double>& theta_rad);

}  // namespace clray
