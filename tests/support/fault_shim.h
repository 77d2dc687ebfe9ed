/* What the parts of the shim share; fault_shim.c says what it does. */
#pragma once

/* Whether calls of this kind are counted. */
int fault_concerns(const char* what);
/* Counts a call; whether it is the one that fails. Sets errno. */
int fault_fails(void);
