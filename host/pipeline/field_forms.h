// In which form the fields of pairs are handed on. What nobody wants is given up by the worker that
// measured it, for whom its memory is at hand.
#pragma once

namespace impactdic::pipeline {

struct FieldForms {
  bool windows = true;   // PairMotion::windows and field
  bool columns = false;  // PairMotion::columns
};

}  // namespace impactdic::pipeline
