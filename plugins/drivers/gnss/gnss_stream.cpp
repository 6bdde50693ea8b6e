// SPDX-License-Identifier: LGPL-3.0-or-later
#include "gnss_stream.h"

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
        return Event::message;
      case UbxFrames::Event::bad:
        return Event::bad;
      case UbxFrames::Event::other:
        event = event_of(sentences_.push(static_cast<char>(messages_.byte())));
        if (event != Event::none) return event;
        break;
      case UbxFrames::Event::none:
        if (!dropped_) return Event::none;
        dropped_ = false;
        return event_of(sentences_.drop_begun());
    }
  }
}

void GnssStream::drop_begun() {
  messages_.drop_begun();
  dropped_ = true;
}

}  // namespace drivers
