// SPDX-License-Identifier: LGPL-3.0-or-later
/// All that shells, cores, state machines and interfaces are made of, in one include.
#pragma once

#include <mauve/call_port.h>
#include <mauve/converts.h>
#include <mauve/core.h>
#include <mauve/fsm.h>
#include <mauve/interface.h>
#include <mauve/job.h>
#include <mauve/log.h>
#include <mauve/observable.h>
#include <mauve/port.h>
#include <mauve/property.h>
#include <mauve/request.h>
#include <mauve/service.h>
#include <mauve/shell.h>
#include <mauve/slow_state.h>
#include <mauve/state.h>
#include <mauve/trace.h>
#include <mauve/type.h>
