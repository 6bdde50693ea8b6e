// SPDX-License-Identifier: LGPL-3.0-or-later
/// The signal mask of a thread that runs a job or hook. The signals by which mauve notices faults
/// and ends jobs stay out of it. The mask is put back behind the job.
#include "rt/calls/original.h"
#include "rt/thread/run_guarded.h"

#include <csignal>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
namespace {

using mauve::rt::in_body;
using mauve::rt::Original;

constinit Original<int(int, const sigset_t*, sigset_t*)> in_library_pthread_sigmask{
    "pthread_sigmask"};
constinit Original<int(int, const sigset_t*, sigset_t*)> in_library_sigprocmask{"sigprocmask"};
constinit Original<int(const sigset_t*)> in_library_sigsuspend{"sigsuspend"};

[[gnu::constructor]] void find_masks() {
  static_cast<void>(in_library_pthread_sigmask.find());
  static_cast<void>(in_library_sigprocmask.find());
  static_cast<void>(in_library_sigsuspend.find());
}

/// Without the signals of mauve, unless the call opens the mask.
sigset_t permitted(const sigset_t& set) {
  sigset_t rest = set;
  for (const int signal : mauve::rt::kSignalsOfBodies) sigdelset(&rest, signal);
  return rest;
}

template <typename Call>
int change_mask(Call* call, int how, const sigset_t* set, sigset_t* before) {
  if (set == nullptr || !in_body()) return call(how, set, before);
  mauve::rt::keep_mask();
  const sigset_t rest = permitted(*set);
  return call(how, how == SIG_UNBLOCK ? set : &rest, before);
}

}  // namespace

extern "C" {

int pthread_sigmask(int how, const sigset_t* set, sigset_t* before) noexcept {
  return change_mask(in_library_pthread_sigmask.find(), how, set, before);
}

int sigprocmask(int how, const sigset_t* set, sigset_t* before) noexcept {
  return change_mask(in_library_sigprocmask.find(), how, set, before);
}

int sigsuspend(const sigset_t* set) {
  const sigset_t rest = permitted(*set);
  return in_library_sigsuspend.find()(in_body() ? &rest : set);
}

}  // extern "C"
#endif
