// SPDX-License-Identifier: LGPL-3.0-or-later
/// Graph: the demand that one component can make of its processor, as a digraph of jobs (Stigge,
/// Ekberg, Guan and Yi, 2011). A vertex is a job. An edge leads to a job that may follow, and has
/// the shortest time between the two releases.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mauve/time.h"

namespace mauve::analysis {

/// The source of an execution time. Of several sources the weakest counts: the last in this list.
enum class Source : std::uint8_t { declared, measured, unknown };

/// "declared", "measured", "unknown"
[[nodiscard]] std::string_view to_string(Source source);

/// The part of a change that a job belongs to.
enum class Part : std::uint8_t {
  steady,       ///< of a component that does not change
  before,       ///< the old version
  first_after,  ///< the job that applies the change: costs more
  after,        ///< the new version
  first_back,   ///< the job that applies the rollback
  back,         ///< the old version, after a rollback
};

/// One kind of job: from the end of the wait `from` until the wait `to` begins.
struct Vertex {
  std::string from;  ///< synchronization state; empty for the first job of a component
  std::string to;    ///< synchronization state that the job ends in
  Duration execution{0};
  Duration deadline{0};  ///< after the release; never later than the next release
  Source source = Source::declared;
  Part part = Part::steady;

  bool operator==(const Vertex&) const = default;
};

/// "from pace to settle", "from start to idle", "from pace to pace (new)"
[[nodiscard]] std::string name(const Vertex& vertex);

/// After a job `from`, a job `to` may be released, `separation` or more after `from` was.
struct Edge {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  Duration separation{0};

  bool operator==(const Edge&) const = default;
};

struct Graph {
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;

  bool operator==(const Graph&) const = default;
};

/// One job each `period`; its deadline is the period.
[[nodiscard]] Graph periodic(Duration period, Duration execution);

/// The adjacency of a graph, in nanoseconds, on which the algorithms walk.
class Arcs {
 public:
  struct Arc {
    std::uint32_t to;
    std::int64_t separation;  ///< at least 1
  };
  explicit Arcs(const Graph& graph);

  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
  [[nodiscard]] const Arc* begin(std::size_t vertex) const { return arcs_.data() + first_[vertex]; }
  [[nodiscard]] const Arc* end(std::size_t vertex) const {
    return arcs_.data() + first_[vertex + 1];
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<Arc> arcs_;
};

}  // namespace mauve::analysis
