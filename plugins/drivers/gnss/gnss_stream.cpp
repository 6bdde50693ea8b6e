// SPDX-License-Identifier: LGPL-3.0-or-later
#include "gnss_stream.h"

#include "ubx_pvt.h"

namespace drivers {
namespace {

GnssStream::Event event_of(FrameReader::Event event) {
  if (event == FrameReader::Event::frame) return GnssStream::Event::sentence;
  if (event == FrameReader::Event::bad) return GnssStream::Event::bad;
  return GnssStream::Event::none;
}

}  // namespace

GnssStream::Event GnssStream::next() {
  const Event found = find();
  if (found == Event::bad) ++bad_;
  return found;
}

GnssStream::Event GnssStream::find() {
  for (;;) {
    Event event = Event::none;
    switch (messages_.next()) {
      case UbxFrames::Event::frame:
        proven_.right(ubx_name(messages_.frame()));
        return Event::message;
      case UbxFrames::Event::bad:
        if (damaged()) return Event::bad;
        break;
      case UbxFrames::Event::other:
        event = event_of(sentences_.push(static_cast<char>(messages_.byte())));
        if (event != Event::none) return event;
        break;
      case UbxFrames::Event::none:
        if (!dropped_) return Event::none;
        dropped_ = false;
        sentences_.drop_begun();
        return Event::none;
    }
  }
}

/// A message whose bytes stayed out has shown no checksum.
bool GnssStream::damaged() {
  const Bytes begun = messages_.begun();
  const std::size_t size = UbxFormat::size(begun);
  if (begun.size() < size) return false;
  return (is_pvt(begun) && (size == 92 || size == 100)) || proven_.wrong(ubx_name(begun));
}

void GnssStream::drop_begun() {
  messages_.drop_begun();
  dropped_ = true;
}

}  // namespace drivers
