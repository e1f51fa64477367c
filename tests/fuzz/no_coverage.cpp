// For programs that link libraries compiled for coverage but are no fuzz targets.
extern "C" void __sanitizer_cov_trace_pc() {}
