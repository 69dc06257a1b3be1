// SPDX-License-Identifier: Apache-2.0
// Expects a MeshError whose message contains given words.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "wellmesh/error.hpp"

namespace wellmesh::testing {

template <class Function>
void expect_error(ErrorCode code, std::initializer_list<std::string_view> words, Function function) {
    try {
        function();
    } catch (const MeshError& error) {
        EXPECT_EQ(error.code(), code) << error.what();
        for (const std::string_view word : words)
            EXPECT_NE(std::string_view(error.what()).find(word), std::string_view::npos) << "no \"" << word << "\" in: " << error.what();
        return;
    }
    ADD_FAILURE() << "no MeshError; expected one about " << (words.size() > 0 ? std::string(*words.begin()) : std::string("anything"));
}

}  // namespace wellmesh::testing
