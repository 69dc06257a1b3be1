// SPDX-License-Identifier: Apache-2.0
// Aligned columns of text.
#pragma once

#include <string>
#include <vector>

namespace wellmesh::cli {

class TextTable {
public:
    enum class Align { left, right };
    struct Column {
        std::string title;
        Align align = Align::left;
    };

    explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }  ///< missing cells are blank
    [[nodiscard]] bool empty() const { return rows_.empty(); }
    [[nodiscard]] std::string str() const;  ///< title line, rule, rows; each line indented by two and ended

private:
    std::vector<Column> columns_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace wellmesh::cli
