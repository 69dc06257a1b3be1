// SPDX-License-Identifier: Apache-2.0
// Names, statements and bounds of the claims.
#pragma once

#include <array>

#include "theory/insertion_ledger.hpp"

namespace wellmesh {

[[nodiscard]] std::array<InvariantClaim, static_cast<std::size_t>(ClaimId::count)> stated_claims(const TheoryConstants& constants);

}  // namespace wellmesh
