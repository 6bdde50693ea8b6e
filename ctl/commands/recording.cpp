// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recording.h"

#include <chrono>
#include <utility>

#include "cli/interrupt.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using namespace std::chrono_literals;
using protocol::wrong_use;

/// The path distinguishes fields within fields; lists stay whole.
void add_channels(const Json& fields, Channel prefix, std::vector<Channel>& channels) {
  for (const Json& field : fields) {
    Channel channel = prefix;
    channel.path.push_back(word(field, "name"));
    channel.unit = word(field, "unit");
    const Json kind = field.value("kind", Json());
    if (kind.is_array()) {
      add_channels(kind, channel, channels);
    } else {
      channels.push_back(std::move(channel));
    }
  }
}

Sample sample_of(const Notification& notification) {
  return {number(notification.params, "t_ns") / 1e9, word(notification.params, "address"),
          notification.method == "dropped" ? Json() : notification.params.value("value", Json())};
}

}  // namespace

std::string Channel::name() const {
  std::string text = address;
  for (const std::string& member : path) text += "." + member;
  return text;
}

Json Channel::in(const Json& value) const {
  const Json* here = &value;
  for (const std::string& member : path) {
    if (!here->is_object() || !here->contains(member)) return {};
    here = &(*here)[member];
  }
  return *here;
}

std::variant<std::vector<Channel>, Fault> channels_of(Session& session,
                                                      const std::string& address) {
  const auto described = session.call("object.get", {{"address", address}});
  if (const auto* object = std::get_if<Json>(&described)) {
    std::vector<Channel> channels;
    add_channels(list_in(*object, "fields"), {address, {}, {}}, channels);
    if (channels.empty()) channels.push_back({address, {}, word(*object, "unit")});
    return channels;
  }
  // Statistics and fields have a value, and nothing else to show.
  const auto value = session.call("param.get", {{"address", address}});
  if (const auto* fault = std::get_if<Fault>(&value)) return *fault;
  return std::vector<Channel>{{address, {}, {}}};
}

std::optional<Fault> follow(Session& session, const std::vector<std::string>& addresses,
                            const std::function<void(const Sample&)>& take) {
  std::chrono::nanoseconds length = 24h * 365;
  if (session.arguments.has("--for")) {
    const auto given = timeout_of(session.arguments.one("--for"));
    if (!given) {
      return wrong_use("usage_not_a_time", "--for takes a time", session.arguments.one("--for"),
                       "example: --for 10s");
    }
    length = *given;
  }
  const auto answer = session.call("watch.subscribe", {{"addresses", addresses}});
  if (const auto* fault = std::get_if<Fault>(&answer)) return *fault;
  const Interrupt interrupt;
  const auto end = std::chrono::steady_clock::now() + length;
  while (!interrupt.came() && std::chrono::steady_clock::now() < end) {
    if (!session.arguments.has("-o,--output")) Session::end_without_a_reader();
    const auto arrived = session.next(std::min(end, std::chrono::steady_clock::now() + 100ms));
    if (const auto* fault = std::get_if<Fault>(&arrived)) {
      if (fault->name == "timed_out") continue;
      return *fault;
    }
    const auto& notification = std::get<Notification>(arrived);
    if (notification.method == "value" || notification.method == "dropped") {
      take(sample_of(notification));
    }
  }
  return std::nullopt;
}

}  // namespace mauve::ctl
