// SPDX-License-Identifier: LGPL-3.0-or-later
#include "gnss_reader.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "ubx_pvt.h"

namespace drivers {

GnssReader::Event GnssReader::read(GnssStream::Event found, const GnssStream& stream, double now,
                                   double speed_limit) {
  Event event = Event::ignored;
  if (mending_ > 0 && !unread()) --mending_;
  const std::uint32_t damaged = stream.bad() - std::exchange(bad_, stream.bad());
  suspect(static_cast<int>(std::min<std::uint32_t>(damaged, 4)));
  if (found == GnssStream::Event::sentence) event = read_sentence(stream.sentence(), now);
  if (found == GnssStream::Event::message) event = read_message(stream.message(), now);
  return admit(event, now, speed_limit);
}

GnssReader::Event GnssReader::overdue(double now, double speed_limit) {
  if (!sentences_.holds() || now - held_since_ <= patience_) return Event::ignored;
  return admit(take(sentences_.release(), now), now, speed_limit);
}

GnssReader::Event GnssReader::admit(Event event, double now, double speed_limit) {
  if (event != Event::fix) return event;
  context_.damage = mending_ > kBad;
  if (!gate_.admit(next_, now, speed_limit, context_)) return Event::implausible;
  fix_ = next_;
  return Event::fix;
}

void GnssReader::suspect(int damaged) {
  mending_ = std::min(mending_ + damaged * kMending, 2 * kBad);
}

GnssReader::Event GnssReader::read_sentence(std::string_view sentence, double now) {
  const bool held = sentences_.holds();
  const FixReader::Event event = sentences_.read(sentence);
  if (!held && sentences_.holds()) held_since_ = now;
  if (held && !sentences_.holds() && !unread()) patience_ = 2.0 * (now - held_since_) + kPatience;
  return take(event, now);
}

GnssReader::Event GnssReader::take(FixReader::Event event, double now) {
  if (event == FixReader::Event::malformed) return Event::malformed;
  if (event != FixReader::Event::fix || now - last_message_ < kSilence) return Event::ignored;
  next_ = sentences_.fix();
  context_ = sentences_.context();
  return Event::fix;
}

GnssReader::Event GnssReader::read_message(Bytes message, double now) {
  if (!is_pvt(message)) return Event::ignored;
  const std::optional<rover::GnssFix> fix = read_pvt(message);
  if (!fix) return Event::malformed;
  last_message_ = now;
  const bool again = fix->mode >= 2 && next_.mode >= 2 && fix->time == message_time_;
  if (again) return Event::ignored;  // some receivers send it on demand too
  message_time_ = fix->time;
  next_ = *fix;
  context_ = {};
  context_.separation = pvt_separation(message);
  return Event::fix;
}

}  // namespace drivers
