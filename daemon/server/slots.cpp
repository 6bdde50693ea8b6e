// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/slots.h"

#include <algorithm>
#include <functional>
#include <string>

namespace mauve::server {
namespace {

using Which = std::function<bool(const Slot&)>;

std::size_t number_of(const std::vector<Slot>& slots, const Which& which) {
  return static_cast<std::size_t>(std::count_if(slots.begin(), slots.end(), which));
}

std::uint64_t first_of(const std::vector<Slot>& slots, const Which& which) {
  const auto found = std::find_if(slots.begin(), slots.end(), which);
  return found == slots.end() ? 0 : found->client;
}

/// A client of the lowest role below this one that has an ordinary slot: an idle one where there is
/// one. Of operators only an idle one, since they may wait for the answer of a change.
std::uint64_t one_below(const std::vector<Slot>& slots, Role role) {
  for (auto lower = Role::viewer; lower < role;
       lower = static_cast<Role>(static_cast<unsigned>(lower) + 1)) {
    const auto has = [&](const Slot& slot) { return !slot.only_urgent && slot.role == lower; };
    const auto idle = first_of(slots, [&](const Slot& slot) { return has(slot) && slot.idle; });
    if (idle != 0) {
      return idle;
    }
    if (const auto any = first_of(slots, has); any != 0 && lower == Role::viewer) {
      return any;
    }
  }
  return 0;
}

/// A client that has not asked yet, or waits for its answer, keeps its place: its request may be
/// the stop. So a newcomer may have to come again, when as many of them are under way at once.
Result<Entry> urgent_entry(const Peer& peer, std::string_view since, const Limits& limits,
                           const std::vector<Slot>& slots) {
  const auto own = [&](const Slot& slot) { return slot.only_urgent && slot.uid == peer.uid; };
  const auto any = [](const Slot& slot) { return slot.only_urgent; };
  const auto idle_own = [&](const Slot& slot) { return own(slot) && slot.idle; };
  const bool own_full = number_of(slots, own) >= limits.stops_per_uid;
  const bool full = own_full || number_of(slots, any) >= limits.reserved_for_stop;
  if (!full) {
    return Entry{since, 0};
  }
  auto displaced = first_of(slots, idle_own);
  if (displaced == 0 && !own_full) {
    displaced = oldest_idle_stop(slots);
  }
  if (displaced != 0) {
    return Entry{since, displaced};
  }
  return refuse({Errc::limit, "too_many_clients"}, "uid " + std::to_string(peer.uid),
                "as many stops as mauved serves at once are under way",
                "try again at once: they are being carried out");
}

}  // namespace

std::uint64_t oldest_idle_stop(const std::vector<Slot>& slots) {
  return first_of(slots, [](const Slot& slot) { return slot.only_urgent && slot.idle; });
}

Result<Entry> entry_for(const Peer& peer, Role role, std::string_view only_urgent_since,
                        const Limits& limits, const std::vector<Slot>& slots) {
  if (role == Role::none) {
    return refuse({Errc::not_permitted, "no_role"}, "uid " + std::to_string(peer.uid),
                  "this user has no role here",
                  "ask to be added to a group, then log in again: 'mauve-view' to look, 'mauve' to "
                  "change");
  }
  const bool may_stop = role >= Role::operator_;
  if (!only_urgent_since.empty()) {
    if (may_stop) {
      return urgent_entry(peer, only_urgent_since, limits, slots);
    }
    return refuse({Errc::limit, "too_many_clients"}, "uid " + std::to_string(peer.uid),
                  std::string(only_urgent_since) + ", and a viewer may do none of these",
                  "use the socket without .stop at the end, or try again later");
  }
  const auto extra = peer.uid == 0 ? limits.reserved_for_root : 0;
  const auto ordinary = [](const Slot& slot) { return !slot.only_urgent; };
  const auto own = [&](const Slot& slot) { return !slot.only_urgent && slot.uid == peer.uid; };
  if (number_of(slots, own) >= limits.clients_per_uid + extra) {
    if (may_stop) {
      return urgent_entry(peer, kAllSlotsInUse, limits, slots);
    }
    return refuse({Errc::limit, "too_many_clients"}, "uid " + std::to_string(peer.uid),
                  "this user has too many connections", "close some; mauvectl list clients");
  }
  if (number_of(slots, ordinary) < limits.clients + extra) {
    return Entry{};
  }
  if (const auto displaced = one_below(slots, role); displaced != 0) {
    return Entry{{}, displaced};
  }
  if (may_stop) {
    return urgent_entry(peer, kAllSlotsInUse, limits, slots);
  }
  return refuse({Errc::limit, "too_many_clients"}, "clients", "too many clients are connected",
                "close some; operators, admins and root get the slots of viewers");
}

}  // namespace mauve::server
