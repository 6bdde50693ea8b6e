// SPDX-License-Identifier: LGPL-3.0-or-later
/// Code that a reload of its plugin would not renew.
int zoo_helper();
int zoo_helper() { return 1; }
