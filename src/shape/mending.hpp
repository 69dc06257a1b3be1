// SPDX-License-Identifier: Apache-2.0
// What is bad in a mesh, or in a zone of it, and what has been tried against it. A pass tries to mend every bad tetrahedron, and those that this makes, by moves of
// its vertices: block by block of space, so that what is worked on stays in the cache, the worst of a block first.
#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "core/shared_array.hpp"
#include "core/workers.hpp"
#include "shape/blocks.hpp"
#include "shape/tet_judge.hpp"
#include "shape/vertex_mover.hpp"

namespace wellmesh {

/// By corners, as taking a vertex out for a trial and putting it back gives tetrahedra new ids.
struct Bad {
    double badness = 0;
    TetStore::Corners corners{};
    TetId last{};             // its id when it was listed
    std::uint32_t block = 0;  // of space
    bool is_mostly_stuck = false;  // for a view, which can't ask
    friend bool operator<(const Bad& a, const Bad& b) { return a.badness != b.badness ? a.badness < b.badness : b.corners < a.corners; }
};

class Mending {
public:
    Mending(ConformingMesh& mesh, const TetJudge& judge, VertexMover& mover) : mesh_(mesh), judge_(judge), mover_(mover) {}

    /// How bad a tetrahedron is; at most the goal if it need not be mended.
    std::function<double(TetId)> badness{};
    /// Does that go by more than its shape?
    bool goes_beyond_shape = false;
    /// Tetrahedra for another turn: a view can't judge them. Empty: there are none.
    std::function<bool(TetId)> must_wait{};
    /// Tetrahedra that are mostly tried in vain, so that a pass tries no more of them than it mends in a certain proportion. Empty: those that are marked.
    std::function<bool(TetId)> is_mostly_stuck{};
    /// Of a view: how many of them share in the patience that a pass has to begin with.
    std::uint64_t sharing = 1;
    /// What to try when no move did. @return whether anything changed; of a view: if not, it may also have left its zone. Empty: nothing.
    std::function<bool(const Bad& bad, const TetStore::Corners& freest_first)> last_resort{};
    /// Asked for each tetrahedron of a pass, with the number of those that wait; false ends the pass.
    using MayGoOn = std::function<bool(std::size_t waiting)>;

    /// Forgets what was tried.
    void begin_anew();
    /// The same, and when stars changed; gives the memory back.
    void forget_tries();
    /// All that is bad now, in left().
    void collect(Workers& workers);
    /// The same, by what was doubtful then and what has become so since. @pre since collect() the goal is what it was, and only that has changed which touch() or
    /// note() was told of, or has gone back to what it was; but not to what it was before collect()
    void collect_again(Workers& workers);
    /// left() is what it was and what touch() has found bad since, as far as that is bad now: what has lost an excuse without being touched is not looked at.
    void collect_touched();
    /// How often collect() has looked at all.
    [[nodiscard]] std::uint64_t collections() const { return collections_; }
    /// Tetrahedra that are as they were, but in another cell.
    void note(const std::vector<TetId>& tets);
    /// Begins a pass: what is left waits again.
    void begin_pass();
    /// Goes on until nothing waits. @return false: it was not to go on
    bool pass(unsigned samples, const MayGoOn& may_go_on);
    /// Neighbours may have mended what is left since, and a tetrahedron may be listed twice: left() is what is bad now, once each.
    void end_pass();
    /// Moves vertices to their optimal-Delaunay points, where nothing gets worse than `floor`. @param waiting  gets those that leave the zone
    bool smooth(const std::vector<VertexId>& vertices, double floor, std::vector<VertexId>& waiting, const MayGoOn& may_go_on);

    /// What this has made: notes when stars changed last, and what is bad now.
    void touch(const std::vector<TetId>& tets);

    /// Could not be mended.
    [[nodiscard]] std::vector<Bad>& left() { return left_; }
    [[nodiscard]] const std::vector<Bad>& left() const { return left_; }
    /// Not tried yet, in any order between passes.
    [[nodiscard]] std::vector<Bad>& waiting() { return heap_; }
    [[nodiscard]] std::size_t count() const { return left_.size() + heap_.size(); }
    /// May the surroundings of this one be smoothed once more?
    [[nodiscard]] bool may_smooth(const Bad& bad);  ///< not of a view

    /// The same for a view of a zone. @pre the whole one is not used before join()
    [[nodiscard]] Mending for_zone(ConformingMesh& view, const TetJudge& judge, VertexMover& mover);
    void join(Mending& zone);

private:
    /// Block by block; the worst of a block first.
    struct IsLater {
        bool operator()(const Bad& a, const Bad& b) const { return a.block != b.block ? a.block > b.block : a < b; }
    };
    struct Stuck {
        std::uint32_t when = 0;
        std::uint32_t pass = 0;
        unsigned failures = 0;                      // since its neighbourhood changed last
        unsigned smoothings = 0, last_resorts = 0;  // in all
    };
    /// Moves of a vertex that failed since its star changed last.
    struct Tried {
        std::uint32_t when = 0;
        std::uint32_t pass = 0, failures = 0;
    };
    /// How many of those that are mostly stuck are still to be tried in a pass.
    class Patience {
    public:
        explicit Patience(std::uint64_t sharing) : sharing_(sharing) {}
        bool allows();
        void note(bool was_mended) { ++(was_mended ? mended_ : failed_); }

    private:
        std::uint64_t sharing_;
        std::uint64_t mended_ = 0, failed_ = 0, refused_ = 0;
    };
    enum class Outcome : std::uint8_t { done, not_now, failed, left_zone };

    Outcome mend(const Bad& bad, unsigned samples);
    [[nodiscard]] Stuck* find_stuck(std::uint64_t key);
    [[nodiscard]] bool is_doubtful(TetId t) const;
    [[nodiscard]] bool is_bad(TetId t, double& how) const;
    void note_doubtful(TetId t);
    [[nodiscard]] Bad listed(TetId t, double badness) const;
    void fit_arrays();

    ConformingMesh& mesh_;
    const TetJudge& judge_;
    VertexMover& mover_;
    Blocks blocks_;
    std::uint32_t clock_ = 0;  // begins again on its way to overflow, between passes; if one pass got there, something would be tried again, or not
    std::uint32_t pass_ = 0;
    SharedArray<std::uint32_t> touched_;               // per vertex: when its star changed last
    SharedArray<Tried> tried_;                         // per vertex
    std::unordered_map<std::uint64_t, Stuck> stuck_;   // by corners; each is looked up, in no order
    const std::unordered_map<std::uint64_t, Stuck>* known_ = nullptr;  // of a view: what the whole knew
    std::vector<Bad> heap_, left_;
    std::vector<Bad> outside_;  // of a view: left its zone
    /// By corners, what was doubtful when all was collected, or is new since and was so then.
    struct Doubtful {
        TetStore::Corners corners{};
        TetId last{};
    };
    std::vector<Doubtful> doubtful_;
    std::size_t most_doubtful_ = 0;  // more take longer than a look at everything
    std::uint64_t collections_ = 0;
};

}  // namespace wellmesh
