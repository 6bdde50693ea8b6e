// SPDX-License-Identifier: LGPL-3.0-or-later
/// Borrowed callables: they refer to a function object of the caller, without memory of their own.
#pragma once

namespace mauve {

/// A borrowed callable `void(const void*)`; lives for one call.
class Visitor {
 public:
  template <typename F>
  Visitor(F& f)
      : object_(&f),
        call_([](void* object, const void* data) { (*static_cast<F*>(object))(data); }) {}
  void operator()(const void* data) const { call_(object_, data); }

 private:
  void* object_;
  void (*call_)(void*, const void*);
};

/// A borrowed callable `void(void*)`.
class Filler {
 public:
  template <typename F>
  Filler(F& f)
      : object_(&f), call_([](void* object, void* data) { (*static_cast<F*>(object))(data); }) {}
  void operator()(void* data) const { call_(object_, data); }

 private:
  void* object_;
  void (*call_)(void*, void*);
};

}  // namespace mauve
