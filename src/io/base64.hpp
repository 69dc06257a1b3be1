// SPDX-License-Identifier: Apache-2.0
// Binary data as text: VTK's XML files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wellmesh::io {

/// Decodes `text` from its start until `most` bytes are there, the text ends, or a character is none of base64's. Blanks between characters are
/// passed over. A padded group may stand anywhere: streams that were encoded one after the other are read as one.
[[nodiscard]] std::string decode_base64(std::string_view text, std::size_t most);

/// As decode_base64, but also says how many characters of `text` were used, the padding of the last group included.
[[nodiscard]] std::string decode_base64(std::string_view text, std::size_t most, std::size_t& used);

}  // namespace wellmesh::io
