// SPDX-License-Identifier: LGPL-3.0-or-later
#include "gnss_stream.h"

namespace drivers {
namespace {

GnssStream::Event told(FrameReader::Event event) {
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
        event = told(sentences_.push(static_cast<char>(messages_.byte())));
        if (event != Event::none) return event;
        break;
      case UbxFrames::Event::none:
        if (!given_up_) return Event::none;
        given_up_ = false;
        return told(sentences_.give_up());
    }
  }
}

void GnssStream::give_up() {
  messages_.give_up();
  given_up_ = true;
}

}  // namespace drivers
