// SPDX-License-Identifier: LGPL-3.0-or-later
#include "supervisor.h"

#include <mauve/request.h>

namespace energy {

mauve::Status Supervisor::on_configure() {
  if (low >= high) return mauve::invalid(low, "must be less than `high`");
  return mauve::ok();
}

void Supervisor::update() {
  const double charge = shell().charge.read();
  if (shell().charge.status() != mauve::DataStatus::new_data) return;
  // The request is wait-free: mauved carries it out later, on a thread of its own. It is false when
  // too many requests wait; the next measurement then asks again.
  if (!saves && charge < low && mauve::request("save_energy")) saves = true;
  if (saves && charge > high && mauve::request("full_speed")) saves = false;
}

}  // namespace energy
