// SPDX-License-Identifier: Apache-2.0
// Points of a .node file with three coordinates, no attributes, no markers and no comments: what compare.py writes.
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

inline std::vector<std::array<double, 3>> read_points(const char* path) {
    std::FILE* file = std::fopen(path, "r");
    std::size_t count = 0, number = 0;
    if (!file || std::fscanf(file, "%zu 3 0 0", &count) != 1) {
        std::fprintf(stderr, "%s: no .node file of points\n", path);
        std::exit(2);
    }
    std::vector<std::array<double, 3>> points(count);
    for (auto& p : points)
        if (std::fscanf(file, "%zu %lf %lf %lf", &number, &p[0], &p[1], &p[2]) != 4) {
            std::fprintf(stderr, "%s: too few points\n", path);
            std::exit(2);
        }
    std::fclose(file);
    return points;
}
