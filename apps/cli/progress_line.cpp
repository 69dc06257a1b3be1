// SPDX-License-Identifier: Apache-2.0
#include "progress_line.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace wellmesh::cli {

namespace {

bool terminal_moves_cursor() {
    const char* term = std::getenv("TERM");
    return isatty(STDERR_FILENO) == 1 && term != nullptr && std::string_view(term) != "dumb";
}

std::size_t terminal_width() {
    winsize size{};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1) return size.ws_col;
    return 80;
}

}  // namespace

ProgressLine::ProgressLine(bool wanted) : enabled_(wanted && terminal_moves_cursor()) {}

void ProgressLine::show(const Progress& progress) {
    if (!enabled_) return;
    std::string line = fmt::format("{}: {} vertices, {} tets, {} bad elements left", to_string(progress.stage), progress.vertices,
                                   progress.tets, progress.unmet_goals);
    line.resize(std::min(line.size(), terminal_width() - 1));  // a wrapped line could not be erased
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    std::fflush(stderr);
    visible_ = true;
}

void ProgressLine::erase() {
    if (!visible_) return;
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    visible_ = false;
}

}  // namespace wellmesh::cli
