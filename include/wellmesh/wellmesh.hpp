// SPDX-License-Identifier: Apache-2.0
// Everything public.
#pragma once

#include "wellmesh/background_mesh.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/convert.hpp"
#include "wellmesh/delaunay.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/exemption.hpp"
#include "wellmesh/generate.hpp"
#include "wellmesh/improve.hpp"
#include "wellmesh/invariants.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/names.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/predicates.hpp"
#include "wellmesh/result.hpp"
#include "wellmesh/run_control.hpp"
#include "wellmesh/tet_mesh.hpp"
#include "wellmesh/vec3.hpp"
#include "wellmesh/version.hpp"
