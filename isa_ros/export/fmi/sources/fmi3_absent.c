/*
 * Functions of FMI 3.0 that a unit with a fixed tick does not have: each refuses with a message.
 */
#include "fmi3.h"
#include "unit.h"

#pragma GCC diagnostic ignored "-Wunused-parameter"

/* A function that a unit of this kind does not have; ARGUMENTS stands in parentheses. */
#define NO_FUNCTION(NAME, ARGUMENTS)         \
  EXPORT fmi3Status fmi3##NAME ARGUMENTS     \
  {                                          \
    return (fmi3Status)unit_refuse(c, #NAME); \
  }

#define REFERENCES const fmi3ValueReference vr[], size_t n
#define FLOATS fmi3Float64 values[], size_t n_values

NO_FUNCTION(EnterEventMode, (fmi3Instance c))
NO_FUNCTION(EnterConfigurationMode, (fmi3Instance c))
NO_FUNCTION(ExitConfigurationMode, (fmi3Instance c))
NO_FUNCTION(EnterContinuousTimeMode, (fmi3Instance c))
NO_FUNCTION(EnterStepMode, (fmi3Instance c))
NO_FUNCTION(EvaluateDiscreteStates, (fmi3Instance c))
NO_FUNCTION(UpdateDiscreteStates,
            (fmi3Instance c, fmi3Boolean *needed, fmi3Boolean *terminates, fmi3Boolean *nominals,
             fmi3Boolean *states, fmi3Boolean *has_next, fmi3Float64 *next))
NO_FUNCTION(GetClock, (fmi3Instance c, REFERENCES, fmi3Clock values[]))
NO_FUNCTION(SetClock, (fmi3Instance c, REFERENCES, const fmi3Clock values[]))
NO_FUNCTION(GetIntervalDecimal,
            (fmi3Instance c, REFERENCES, fmi3Float64 intervals[],
             fmi3IntervalQualifier qualifiers[]))
NO_FUNCTION(GetIntervalFraction,
            (fmi3Instance c, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
             fmi3IntervalQualifier qualifiers[]))
NO_FUNCTION(GetShiftDecimal, (fmi3Instance c, REFERENCES, fmi3Float64 shifts[]))
NO_FUNCTION(GetShiftFraction,
            (fmi3Instance c, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
NO_FUNCTION(SetIntervalDecimal, (fmi3Instance c, REFERENCES, const fmi3Float64 intervals[]))
NO_FUNCTION(SetIntervalFraction,
            (fmi3Instance c, REFERENCES, const fmi3UInt64 counters[],
             const fmi3UInt64 resolutions[]))
NO_FUNCTION(SetShiftDecimal, (fmi3Instance c, REFERENCES, const fmi3Float64 shifts[]))
NO_FUNCTION(SetShiftFraction,
            (fmi3Instance c, REFERENCES, const fmi3UInt64 counters[],
             const fmi3UInt64 resolutions[]))
NO_FUNCTION(GetNumberOfVariableDependencies,
            (fmi3Instance c, fmi3ValueReference vr, size_t *n))
NO_FUNCTION(GetVariableDependencies,
            (fmi3Instance c, fmi3ValueReference vr, size_t of[], fmi3ValueReference on[],
             size_t elements[], fmi3DependencyKind kinds[], size_t n))
NO_FUNCTION(GetDirectionalDerivative,
            (fmi3Instance c, REFERENCES, const fmi3ValueReference known[], size_t n_known,
             const fmi3Float64 seed[], size_t n_seed, FLOATS))
NO_FUNCTION(GetAdjointDerivative,
            (fmi3Instance c, REFERENCES, const fmi3ValueReference known[], size_t n_known,
             const fmi3Float64 seed[], size_t n_seed, FLOATS))
NO_FUNCTION(GetOutputDerivatives,
            (fmi3Instance c, REFERENCES, const fmi3Int32 orders[], FLOATS))
NO_FUNCTION(CompletedIntegratorStep,
            (fmi3Instance c, fmi3Boolean is_final, fmi3Boolean *event, fmi3Boolean *terminates))
NO_FUNCTION(SetTime, (fmi3Instance c, fmi3Float64 time))
NO_FUNCTION(SetContinuousStates, (fmi3Instance c, const fmi3Float64 values[], size_t n_values))
NO_FUNCTION(GetContinuousStates, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetContinuousStateDerivatives, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetNominalsOfContinuousStates, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetEventIndicators, (fmi3Instance c, FLOATS))
NO_FUNCTION(GetNumberOfEventIndicators, (fmi3Instance c, size_t *n))
NO_FUNCTION(GetNumberOfContinuousStates, (fmi3Instance c, size_t *n))
NO_FUNCTION(ActivateModelPartition,
            (fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time))
