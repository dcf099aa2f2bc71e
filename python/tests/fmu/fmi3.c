/* The functions of FMI 3 of van_der_pol.h. */

#include "van_der_pol.h"
#include "fmi3FunctionTypes.h"

#define STUB(name) fmi3Status name(void) { return fmi3Error; }

const char *fmi3GetVersion(void) { return "3.0"; }
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String s[]) { return fmi3OK; }
fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String place, fmi3Boolean visible, fmi3Boolean on,
                                          fmi3InstanceEnvironment e, fmi3LogMessageCallback l) { return make(); }
fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String place, fmi3Boolean visible, fmi3Boolean on,
                                         fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference r[], size_t n,
                                         fmi3InstanceEnvironment e, fmi3LogMessageCallback l, fmi3IntermediateUpdateCallback u) {
    return make();
}
void fmi3FreeInstance(fmi3Instance c) { free(c); }
fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean d, fmi3Float64 t, fmi3Float64 start, fmi3Boolean s, fmi3Float64 stop) {
    ((Model *)c)->mode = INITIALISATION, ((Model *)c)->v[TIME] = start;
    return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return leave(c); }
fmi3Status fmi3EnterEventMode(fmi3Instance c) { return fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }
fmi3Status fmi3Reset(fmi3Instance c) { start(c); return fmi3OK; }
fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t m) {
    for (size_t k = 0; k < n; k++) v[k] = get(c, r[k]);
    return fmi3OK;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[], size_t m) {
    int status = fmi3OK;
    for (size_t k = 0; k < n && !status; k++) status = set(c, r[k], v[k]);
    return status;
}
fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) {
    if (!*s) *s = malloc(sizeof(Model));
    memcpy(*s, c, sizeof(Model));
    return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) { return restore(c, s); }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s) { free(*s); *s = 0; return fmi3OK; }
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference z[], size_t nz, const fmi3ValueReference v[], size_t nv,
                                        const fmi3Float64 seed[], size_t ns, fmi3Float64 found[], size_t nf) {
    for (size_t i = 0; i < nz; i++) {
        found[i] = 0;
        for (size_t j = 0; j < nv; j++) found[i] += partial(c, z[i], v[j]) * seed[j];
    }
    return fmi3OK;
}
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *end, fmi3Boolean *nominals, fmi3Boolean *values,
                                    fmi3Boolean *defined, fmi3Float64 *time) {
    Model *m = c;
    *again = *end = *nominals = *values = *defined = false;
    if (m->v[X0] < m->v[FLOOR]) m->v[X1] = -m->v[X1], *values = true;
    return fmi3OK;
}
fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) { return fmi3OK; }
fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean n, fmi3Boolean *event, fmi3Boolean *end) {
    *event = *end = false;
    return fmi3OK;
}
fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 t) { ((Model *)c)->v[TIME] = t; return fmi3OK; }
fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t n) {
    ((Model *)c)->v[X0] = x[0], ((Model *)c)->v[X1] = x[1];
    return fmi3OK;
}
fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 d[], size_t n) {
    d[0] = get(c, DX0), d[1] = get(c, DX1);
    return fmi3OK;
}
fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 z[], size_t n) {
    z[0] = ((Model *)c)->v[X0] - ((Model *)c)->v[FLOOR];
    return fmi3OK;
}
fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n) { x[0] = get(c, X0), x[1] = get(c, X1); return fmi3OK; }
fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n) { x[0] = x[1] = 1; return fmi3OK; }
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 dt, fmi3Boolean n, fmi3Boolean *event, fmi3Boolean *end,
                      fmi3Boolean *early, fmi3Float64 *last) {
    *event = *end = *early = false;
    *last = time + dt;
    return macro_step(c, time, dt);
}
STUB(fmi3InstantiateScheduledExecution) STUB(fmi3GetFloat32) STUB(fmi3GetInt8) STUB(fmi3GetUInt8) STUB(fmi3GetInt16)
STUB(fmi3GetUInt16) STUB(fmi3GetInt32) STUB(fmi3GetUInt32) STUB(fmi3GetInt64) STUB(fmi3GetUInt64) STUB(fmi3GetBoolean)
STUB(fmi3GetString) STUB(fmi3GetBinary) STUB(fmi3GetClock) STUB(fmi3SetFloat32) STUB(fmi3SetInt8) STUB(fmi3SetUInt8)
STUB(fmi3SetInt16) STUB(fmi3SetUInt16) STUB(fmi3SetInt32) STUB(fmi3SetUInt32) STUB(fmi3SetInt64) STUB(fmi3SetUInt64)
STUB(fmi3SetBoolean) STUB(fmi3SetString) STUB(fmi3SetBinary) STUB(fmi3SetClock) STUB(fmi3GetNumberOfVariableDependencies)
STUB(fmi3GetVariableDependencies) STUB(fmi3SerializedFMUStateSize) STUB(fmi3SerializeFMUState) STUB(fmi3DeserializeFMUState)
STUB(fmi3GetAdjointDerivative) STUB(fmi3EnterConfigurationMode) STUB(fmi3ExitConfigurationMode) STUB(fmi3GetIntervalDecimal)
STUB(fmi3GetIntervalFraction) STUB(fmi3GetShiftDecimal) STUB(fmi3GetShiftFraction) STUB(fmi3SetIntervalDecimal)
STUB(fmi3SetIntervalFraction) STUB(fmi3SetShiftDecimal) STUB(fmi3SetShiftFraction) STUB(fmi3EvaluateDiscreteStates)
STUB(fmi3GetNumberOfEventIndicators) STUB(fmi3GetNumberOfContinuousStates) STUB(fmi3EnterStepMode) STUB(fmi3GetOutputDerivatives)
STUB(fmi3ActivateModelPartition)
