// SPDX-License-Identifier: LGPL-3.0-or-later
/// A shared object that is no plugin at all.
namespace zoo {
int answer() { return 42; }
}  // namespace zoo
