// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/resource/resource_graph.h"

#include <algorithm>
#include <string>

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>

namespace mauve {
namespace {

std::vector<const ResourceBase*> ways_of(const Bindings& bindings) {
  std::vector<const ResourceBase*> ways;
  for (const auto& binding : bindings) {
    if (binding != nullptr) ways.push_back(&binding->service().resource());
  }
  return ways;
}

}  // namespace

/// Depth first; the path has the locks that a thread would hold.
class ResourceGraph::Walk {
 public:
  explicit Walk(const ResourceGraph& graph) : graph_(graph) {}

  Status visit(const ResourceBase& resource) {
    for (std::size_t i = 0; i < path_.size(); ++i) {
      if (path_[i] == &resource) return cycle(i);
    }
    path_.push_back(&resource);
    std::size_t& depth = depths_[&resource];
    if (depth > 0) {
      if (path_.size() - 1 + depth > Job::kMaxHeld) return too_deep();
    } else if (Status below = measure(resource, depth); !below) {
      return below;
    }
    path_.pop_back();
    return ok();
  }

 private:
  /// How many resource locks a thread holds at most from this one on.
  Status measure(const ResourceBase& resource, std::size_t& depth) {
    if (path_.size() > Job::kMaxHeld) return too_deep();
    std::size_t below = 0;
    const auto ways = graph_.ways_.find(&resource);
    if (ways != graph_.ways_.end()) {
      for (const ResourceBase* next : ways->second) {
        if (Status step = visit(*next); !step) return step;
        below = std::max(below, depths_[next]);
      }
    }
    depth = 1 + below;
    return ok();
  }
  [[nodiscard]] Error too_deep() const {
    return refuse({Errc::limit, "resources_too_deep"}, path_.back()->name(),
                  "resources nest deeper than " + std::to_string(Job::kMaxHeld));
  }
  [[nodiscard]] Error cycle(std::size_t first) const {
    std::string text;
    for (std::size_t i = first; i < path_.size(); ++i) text += path_[i]->name() + " -> ";
    return refuse({Errc::cycle, "resources_wait_in_circle"}, path_[first]->name(),
                  "resources would wait for each other for ever: " + text + path_[first]->name(),
                  "disconnect one of these ports");
  }

  const ResourceGraph& graph_;
  std::vector<const ResourceBase*> path_;
  std::map<const ResourceBase*, std::size_t> depths_;  // zero: not known yet
};

ResourceGraph::ResourceGraph(const Architecture& architecture) {
  for (const ResourceBase* resource : architecture.resources()) {
    ways_[resource] = ways_of(resource->bindings());
    order_.push_back(resource);
  }
}

void ResourceGraph::let_begin(const ResourceBase& resource) {
  std::erase(order_, &resource);
  order_.insert(order_.begin(), &resource);
}

void ResourceGraph::put(const ResourceBase& resource, const Bindings& bindings) {
  ways_[&resource] = ways_of(bindings);
  let_begin(resource);
}

void ResourceGraph::connect(const ResourceBase& from, const ResourceBase& into) {
  ways_[&from].push_back(&into);
  let_begin(from);
}

void ResourceGraph::remove(const ResourceBase& resource) {
  ways_.erase(&resource);
  std::erase(order_, &resource);
}

Status ResourceGraph::check() const {
  Walk walk(*this);
  for (const ResourceBase* resource : order_) {
    if (Status sound = walk.visit(*resource); !sound) return sound;
  }
  return ok();
}

}  // namespace mauve
