
/*
 * Of the unit of @NAME@ alone: numbers of the actuator that are read or changed between ticks, by their
 * places in its memory, which stands above.
 */
void ISA(put_number)(@NAME@_t *self, int32_t place, double value);
double ISA(number)(const @NAME@_t *self, int32_t place);
int64_t *ISA(flag)(@NAME@_t *self, int32_t place);

void ISA(put_number)(@NAME@_t *self, int32_t place, double value)
{
  *(double *)(self->block + place) = value;
}

double ISA(number)(const @NAME@_t *self, int32_t place)
{
  return *(const double *)(self->block + place);
}

int64_t *ISA(flag)(@NAME@_t *self, int32_t place)
{
  return (int64_t *)(self->block + place);
}
