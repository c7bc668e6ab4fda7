
/*
 * Of the unit of @NAME@ alone: numbers of the actuator that change between two ticks, by their
 * places in its memory, which stands above.
 */
void ISA(put_number)(@NAME@_t *self, int32_t place, double value);
int64_t *ISA(flag)(@NAME@_t *self, int32_t place);

void ISA(put_number)(@NAME@_t *self, int32_t place, double value)
{
  *(double *)(self->block + place) = value;
}

int64_t *ISA(flag)(@NAME@_t *self, int32_t place)
{
  return (int64_t *)(self->block + place);
}
