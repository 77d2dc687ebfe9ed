// All of the library.
#pragma once

#include <impactdic/advice.h>
#include <impactdic/batch.h>
#include <impactdic/circle.h>
#include <impactdic/clip.h>
#include <impactdic/compare.h>
#include <impactdic/control.h>
#include <impactdic/correlate.h>
#include <impactdic/device.h>
#include <impactdic/error.h>
#include <impactdic/export.h>
#include <impactdic/field.h>
#include <impactdic/fit.h>
#include <impactdic/image.h>
#include <impactdic/impact.h>
#include <impactdic/impact_model.h>
#include <impactdic/measured.h>
#include <impactdic/rod.h>
#include <impactdic/rod_model.h>
#include <impactdic/simulate.h>
#include <impactdic/study.h>
#include <impactdic/synth.h>
#include <impactdic/track.h>
#include <impactdic/uncertainty.h>
#include <impactdic/units.h>
#include <impactdic/version.h>
