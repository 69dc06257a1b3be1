// SPDX-License-Identifier: Apache-2.0
#include "shape/zone_passes.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "core/shared_guard.hpp"
#include "delaunay/zones.hpp"
#include "shape/corners.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kLeastBadAZone = 64, kLeastVerticesAZone = 256;
constexpr std::size_t kSampleAZone = 512;

/// One in five of those that wait in such a pass gets a vertex. Who finds no room waits for the whole.
ConformingMesh::ZoneRoom room_for_insertions(std::size_t waiting) {
    ConformingMesh::ZoneRoom room;
    room.vertices = waiting / 3 + 16;
    room.tets += 8 * room.vertices;
    room.records += 4 * room.vertices;
    return room;
}

}  // namespace

/// Whoever works in one zone, and what it works with.
class ZonePasses::Team {
public:
    struct Member {
        Member(ZonePasses& whole, ConformingMesh& view)
            : mesh(view),
              boundary(view, whole.guard_, whole.boundary_.seed(), whole.boundary_.acute()),
              judge(view, whole.judge_),
              mover(whole.mover_.for_zone(view, boundary, judge)),
              insertion(whole.insertion_.for_zone(view, boundary, judge)),
              mending(whole.mending_.for_zone(view, judge, mover)) {
            mending.badness = [this](TetId t) { return judge.shape_badness(t); };
            if (whole.mending_.goes_beyond_shape) mending.must_wait = [this](TetId t) { return !judge.keeps_radius_edge(t); };
        }
        Member(const Member&) = delete;
        Member& operator=(const Member&) = delete;

        ConformingMesh& mesh;
        BoundaryRefiner boundary;
        TetJudge judge;
        VertexMover mover;
        BestInsertion insertion;
        Mending mending;
        std::vector<VertexId> vertices, waiting;
    };

    Team(ZonePasses& whole, const Zones& zones, const ConformingMesh::ZoneRoom& room) : whole_(whole), views_(whole.mesh_.split(whole.workers_, zones, room, parts_)) {
        for (ConformingMesh& view : views_) members_.push_back(std::make_unique<Member>(whole, view));
    }
    [[nodiscard]] Member& operator[](std::size_t z) { return *members_[z]; }
    [[nodiscard]] std::uint8_t zone_of(VertexId v) const { return parts_.zone_of_vertex[v.index()]; }

    /// Calls work(member, may_go_on) for all, then joins what they did.
    template <class Work>
    RunGuard::Verdict run(const Work& work) {
        SharedGuard guard(whole_.guard_, whole_.mesh_.vertex_count(), whole_.mesh_.tets().live());
        whole_.workers_.for_each(members_.size(), [&](std::size_t z) { guard.watch([&] { work(*members_[z], [&guard](std::size_t waiting) { return guard.may_go_on(waiting); }); }); });
        whole_.mesh_.join(views_);
        for (const auto& m : members_) {
            whole_.mover_.join(m->mover);
            whole_.insertion_.join(m->insertion);
            whole_.mending_.join(m->mending);
        }
        return guard.verdict();
    }

private:
    ZonePasses& whole_;
    ZoneViews parts_;
    std::vector<ConformingMesh> views_;
    std::vector<std::unique_ptr<Member>> members_;
};

RunGuard::Verdict ZonePasses::mend(unsigned samples, LastResort last_resort) {
    // Moves change no number of vertices, and there is room below the limit for all that last resorts may put in: whether there are too many does not depend on who asks first.
    RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), mending_.count());
    const bool resorts = last_resort != LastResort::none;
    for (unsigned turn = 0; turn < Zones::kTurns && verdict == RunGuard::Verdict::go_on; ++turn) {
        std::vector<Bad>& waiting = mending_.waiting();
        const std::size_t count = Zones::worth(mesh_.tets().live(), waiting.size(), kLeastBadAZone, turn);
        if (count < 2 || (resorts && guard_.has_too_many(mesh_.vertex_count() + waiting.size()))) break;
        std::vector<Vec3> sample;
        const std::size_t step = std::max<std::size_t>(1, waiting.size() / (kSampleAZone * count));
        // Corners that are gone still have their places.
        for (std::size_t k = 0; k < waiting.size(); k += step) sample.push_back(mesh_.point(waiting[k].corners[0]));
        if (resorts && mending_.is_mostly_stuck)
            for (Bad& b : waiting) {
                const TetId t = find_tet(mesh_, b.corners, b.last);
                b.is_mostly_stuck = t.valid() && mending_.is_mostly_stuck(t);
            }
        Team team(*this, Zones(std::move(sample), count, turn), resorts ? room_for_insertions(waiting.size() / count) : ConformingMesh::ZoneRoom{});
        std::vector<Bad> outside;
        for (const Bad& b : waiting) {
            const std::uint8_t zone = team.zone_of(b.corners[0]);
            const bool inside = std::all_of(b.corners.begin(), b.corners.end(), [&](VertexId v) { return team.zone_of(v) == zone && mesh_.triangulation().is_inserted(v); });
            (inside ? team[zone].mending.waiting() : outside).push_back(b);
        }
        waiting = std::move(outside);
        verdict = team.run([&](Team::Member& m, const Mending::MayGoOn& may_go_on) {
            m.mending.sharing = count;
            if (resorts)
                m.mending.last_resort = [&m, last_resort](const Bad& bad, const TetStore::Corners& freest_first) {
                    return try_last_resort(last_resort, m.mesh, m.mover, m.insertion, m.mending, m.judge, bad, freest_first);
                };
            m.mending.pass(samples, may_go_on);
        });
    }
    return verdict;
}

/// Gives each zone its vertices, in their order, and leaves those that wait afterwards.
template <class Work>
RunGuard::Verdict ZonePasses::share_out(std::vector<VertexId>& vertices, std::size_t zones, unsigned turn, const Work& work) {
    std::vector<Vec3> sample;
    const std::size_t step = std::max<std::size_t>(1, vertices.size() / (kSampleAZone * zones));
    for (std::size_t k = 0; k < vertices.size(); k += step) sample.push_back(mesh_.point(vertices[k]));
    Team team(*this, Zones(std::move(sample), zones, turn), {});
    for (const VertexId v : vertices) team[team.zone_of(v)].vertices.push_back(v);
    vertices.clear();
    const RunGuard::Verdict verdict = team.run(work);
    for (std::size_t z = 0; z < zones; ++z) vertices.insert(vertices.end(), team[z].waiting.begin(), team[z].waiting.end());
    return verdict;
}

RunGuard::Verdict ZonePasses::smooth(std::vector<VertexId>& vertices, double floor) {
    RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), mending_.count());
    for (unsigned turn = 0; turn < Zones::kTurns && verdict == RunGuard::Verdict::go_on; ++turn) {
        const std::size_t zones = Zones::worth(mesh_.tets().live(), vertices.size(), kLeastVerticesAZone, turn);
        if (zones < 2) break;
        verdict = share_out(vertices, zones, turn, [&](Team::Member& m, const Mending::MayGoOn& may_go_on) { m.mending.smooth(m.vertices, floor, m.waiting, may_go_on); });
    }
    return verdict;
}

}  // namespace wellmesh
