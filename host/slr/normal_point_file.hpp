// SPDX-License-Identifier: Apache-2.0
// What a CRD file says beside its ranges: angles of the station's telescope, normal points, statistics.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slr/crd.hpp"
#include "slr/normal_points.hpp"
#include "slr/session.hpp"

namespace clray::slr {

/// Where the body stands at a shot, if the session knows its orbit.
std::optional<CrdAngles> angles_at(const Session& session, std::uint64_t shot);

CrdStatistics crd_statistics(const ResidualStatistics& statistics);

/// Writes the normal points of a session whose full-rate file has that header and first supplement. Throws
/// Error(output).
void write_normal_points(const std::string& path, CrdHeader header, const CrdSupplement& supplement,
                         const Session& session, const Station& station, const NormalPoints& points);

}  // namespace clray::slr
