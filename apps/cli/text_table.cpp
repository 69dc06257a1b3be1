// SPDX-License-Identifier: Apache-2.0
#include "text_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wellmesh::cli {

std::string TextTable::str() const {
    std::vector<std::size_t> widths;
    for (const Column& column : columns_) widths.push_back(column.title.size());
    for (const auto& row : rows_)
        for (std::size_t i = 0; i < std::min(row.size(), widths.size()); ++i) widths[i] = std::max(widths[i], row[i].size());

    const auto line = [&](auto&& cell) {
        std::string text = "  ";
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const std::string& content = cell(i);
            text += columns_[i].align == Align::left ? fmt::format("{:<{}}", content, widths[i]) : fmt::format("{:>{}}", content, widths[i]);
            text += "  ";
        }
        text.erase(text.find_last_not_of(' ') + 1);
        return text + '\n';
    };
    const std::string blank;
    std::string text = line([&](std::size_t i) -> const std::string& { return columns_[i].title; });
    std::vector<std::string> rules;
    for (const std::size_t width : widths) rules.emplace_back(width, '-');
    text += line([&](std::size_t i) -> const std::string& { return rules[i]; });
    for (const auto& row : rows_) text += line([&](std::size_t i) -> const std::string& { return i < row.size() ? row[i] : blank; });
    return text;
}

}  // namespace wellmesh::cli
