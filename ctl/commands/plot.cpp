// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/output.h"
#include "commands/actions.h"
#include "commands/recording.h"
#include "picture/series_picture.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

double value_of(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  return value.is_number() ? value.get<double>() : kGap;
}

/// A value holds until the next one of its address: a value that does not change arrives once.
void hold_to_the_end(std::vector<Series>& all, double end) {
  for (Series& series : all) {
    if (!series.points.empty()) series.points.push_back({end, series.points.back().y});
  }
}

Fault no_numbers(const Session& session) {
  return protocol::wrong_use("usage_nothing_to_draw", "there was no number to plot",
                             session.arguments.one("ADDRESS"), "mauvectl get shows what it is");
}

}  // namespace

int run_plot(Session& session) {
  if (const auto refused = refused_output(session, kPictureOutput)) return session.fail(*refused);
  const std::vector<std::string> addresses = session.arguments.all("ADDRESS");
  std::vector<Channel> channels;
  for (const std::string& address : addresses) {
    auto found = channels_of(session, address);
    if (const auto* fault = std::get_if<Fault>(&found)) return session.fail(*fault);
    for (Channel& channel : std::get<std::vector<Channel>>(found)) {
      if (channel.name() != address + ".time") channels.push_back(std::move(channel));
    }
  }
  std::vector<Series> all;
  for (const Channel& channel : channels) all.push_back({channel.name(), channel.unit, {}});
  double end = 0.0;
  const auto fault = follow(session, addresses, [&](const Sample& sample) {
    end = std::max(end, sample.time);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (channels[i].address != sample.address) continue;
      all[i].points.push_back({sample.time, value_of(channels[i].in(sample.value))});
    }
  });
  std::erase_if(all, [](const Series& series) {
    return std::none_of(series.points.begin(), series.points.end(),
                        [](const Place& point) { return std::isfinite(point.y); });
  });
  if (all.empty()) return session.fail(fault.value_or(no_numbers(session)));
  std::uint64_t values = 0;
  for (const Series& series : all) values += series.points.size();
  hold_to_the_end(all, end);
  const int written = write_output(session, kPictureOutput, draw_series(all),
                                   "drew " + counted(values, "value"), {{"values", values}});
  return fault ? session.fail(*fault) : written;  // the values before the daemon went are drawn
}

}  // namespace mauve::ctl
