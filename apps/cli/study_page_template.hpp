// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace wellmesh::cli {

/// study_page.html, put into the program when it is built. Places in double braces, to be filled in.
extern const char* const kStudyPageTemplate;

}  // namespace wellmesh::cli
