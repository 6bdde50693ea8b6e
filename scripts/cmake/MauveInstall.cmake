# SPDX-License-Identifier: LGPL-3.0-or-later
# What `cmake --install` puts where. Only targets and files that exist are installed.
