"""
The functions of C that machine code of kernels may call, defined here: an object needs no library.

They are LLVM's text. Each gives what C's gives, bit for bit, but for the bits of a NaN: `floor`,
`ceil`, `rint`, `fmod` and `frexp` are exact, and the others copy bytes; two are of numba itself.
They are weak and hidden: a program that an object is linked into keeps its own.
"""

_MAGNITUDE = (1 << 63) - 1
_FRACTION = (1 << 52) - 1
_INFINITY = 0x7ff << 52

_FLOOR = """
define weak_odr hidden double @floor(double %x) nounwind {
  %size = call double @llvm.fabs.f64(double %x)
  %has_fraction = fcmp olt double %size, 0x4330000000000000   ; 2^52
  br i1 %has_fraction, label %round, label %whole
round:
  %number = fptosi double %x to i64
  %towards_zero = sitofp i64 %number to double
  %is_above = fcmp ogt double %towards_zero, %x
  %less = fsub double %towards_zero, 1.0
  %below = select i1 %is_above, double %less, double %towards_zero
  %signed = call double @llvm.copysign.f64(double %below, double %x)
  ret double %signed
whole:
  ret double %x
}

define weak_odr hidden double @ceil(double %x) nounwind {
  %opposite = fneg double %x
  %below = call double @floor(double %opposite)
  %above = fneg double %below
  ret double %above
}
"""

# Halves go to even: the sum has no bits for what is less than 1.
_RINT = """
define weak_odr hidden double @rint(double %x) nounwind {
  %size = call double @llvm.fabs.f64(double %x)
  %has_fraction = fcmp olt double %size, 0x4330000000000000   ; 2^52
  br i1 %has_fraction, label %round, label %whole
round:
  %sum = fadd double %size, 0x4330000000000000
  %number = fsub double %sum, 0x4330000000000000
  %signed = call double @llvm.copysign.f64(double %number, double %x)
  ret double %signed
whole:
  ret double %x
}
"""

# Mantissa of 0.5 to 1 and exponent; those of 0, an infinity and a NaN are themselves and 0.
_FREXP = f"""
define weak_odr hidden double @numba_frexp(double %x, ptr %exponent) nounwind {{
  %bits = bitcast double %x to i64
  %size = and i64 %bits, {_MAGNITUDE}
  %is_zero = icmp eq i64 %size, 0
  %is_endless = icmp uge i64 %size, {_INFINITY}
  %is_itself = or i1 %is_zero, %is_endless
  br i1 %is_itself, label %itself, label %split
itself:
  store i32 0, ptr %exponent, align 4
  ret double %x
split:
  %is_small = icmp ult i64 %size, {1 << 52}
  %larger = fmul double %x, 0x4350000000000000   ; 2^54: no longer subnormal
  %normal = select i1 %is_small, double %larger, double %x
  %added = select i1 %is_small, i32 -1076, i32 -1022
  %own = bitcast double %normal to i64
  %shifted = lshr i64 %own, 52
  %low = and i64 %shifted, 2047
  %biased = trunc i64 %low to i32
  %power = add i32 %biased, %added
  store i32 %power, ptr %exponent, align 4
  %kept = and i64 %own, {(1 << 64) - 1 - _INFINITY}
  %half = or i64 %kept, {1022 << 52}
  %mantissa = bitcast i64 %half to double
  ret double %mantissa
}}
"""

# Long division of the mantissas, one bit of the quotient a round: exact.
_FMOD = f"""
define internal {{i64, i64}} @isa_split(i64 %size) nounwind {{
  %fraction = and i64 %size, {_FRACTION}
  %biased = lshr i64 %size, 52
  %is_normal = icmp ne i64 %biased, 0
  %whole = or i64 %fraction, {1 << 52}
  %zeros = call i64 @llvm.ctlz.i64(i64 %fraction, i1 false)
  %by = sub i64 %zeros, 11
  %fits = and i64 %by, 63
  %moved = shl i64 %fraction, %fits
  %lower = sub i64 1, %by
  %mantissa = select i1 %is_normal, i64 %whole, i64 %moved
  %power = select i1 %is_normal, i64 %biased, i64 %lower
  %one = insertvalue {{i64, i64}} undef, i64 %mantissa, 0
  %both = insertvalue {{i64, i64}} %one, i64 %power, 1
  ret {{i64, i64}} %both
}}

define weak_odr hidden double @fmod(double %x, double %y) nounwind {{
start:
  %x_bits = bitcast double %x to i64
  %y_bits = bitcast double %y to i64
  %x_size = and i64 %x_bits, {_MAGNITUDE}
  %y_size = and i64 %y_bits, {_MAGNITUDE}
  %sign = xor i64 %x_bits, %x_size
  %by_zero = icmp eq i64 %y_size, 0
  %by_nan = icmp ugt i64 %y_size, {_INFINITY}
  %of_endless = icmp uge i64 %x_size, {_INFINITY}
  %either = or i1 %by_zero, %by_nan
  %is_none = or i1 %either, %of_endless
  br i1 %is_none, label %none, label %compare
none:
  %product = fmul double %x, %y
  %nan = fdiv double %product, %product
  ret double %nan
compare:
  %is_less = icmp ult i64 %x_size, %y_size
  br i1 %is_less, label %same, label %divide
same:
  ret double %x
divide:
  %x_parts = call {{i64, i64}} @isa_split(i64 %x_size)
  %y_parts = call {{i64, i64}} @isa_split(i64 %y_size)
  %x_mantissa = extractvalue {{i64, i64}} %x_parts, 0
  %x_power = extractvalue {{i64, i64}} %x_parts, 1
  %y_mantissa = extractvalue {{i64, i64}} %y_parts, 0
  %y_power = extractvalue {{i64, i64}} %y_parts, 1
  br label %bit
bit:
  %left = phi i64 [%x_mantissa, %divide], [%doubled, %next]
  %power = phi i64 [%x_power, %divide], [%halved, %next]
  %less = sub i64 %left, %y_mantissa
  %goes = icmp sge i64 %less, 0
  %rest = select i1 %goes, i64 %less, i64 %left
  %is_last = icmp eq i64 %power, %y_power
  br i1 %is_last, label %end, label %next
next:
  %doubled = shl i64 %rest, 1
  %halved = sub i64 %power, 1
  br label %bit
end:
  %is_zero = icmp eq i64 %rest, 0
  br i1 %is_zero, label %zero, label %remainder
zero:
  %signed_zero = bitcast i64 %sign to double
  ret double %signed_zero
remainder:
  %zeros = call i64 @llvm.ctlz.i64(i64 %rest, i1 true)
  %by = sub i64 %zeros, 11
  %mantissa = shl i64 %rest, %by
  %own_power = sub i64 %y_power, %by
  %is_normal = icmp sgt i64 %own_power, 0
  br i1 %is_normal, label %normal, label %subnormal
normal:
  %fraction = and i64 %mantissa, {_FRACTION}
  %high = shl i64 %own_power, 52
  %size = or i64 %fraction, %high
  %bits = or i64 %size, %sign
  %value = bitcast i64 %bits to double
  ret double %value
subnormal:
  %down = sub i64 1, %own_power
  %low = lshr i64 %mantissa, %down
  %low_bits = or i64 %low, %sign
  %low_value = bitcast i64 %low_bits to double
  ret double %low_value
}}
"""

_MEMSET = """
define weak_odr hidden ptr @memset(ptr %to, i32 %value, i64 %n) nounwind "no-builtins" {
start:
  %byte = trunc i32 %value to i8
  br label %check
check:
  %k = phi i64 [0, %start], [%after, %put]
  %is_done = icmp eq i64 %k, %n
  br i1 %is_done, label %end, label %put
put:
  %place = getelementptr i8, ptr %to, i64 %k
  store volatile i8 %byte, ptr %place, align 1
  %after = add i64 %k, 1
  br label %check
end:
  ret ptr %to
}
"""

# `memmove` copies from the end where the target is above the source.
_MEMMOVE = """
define weak_odr hidden ptr @memmove(ptr %to, ptr %from, i64 %n) nounwind "no-builtins" {
start:
  %is_above = icmp ugt ptr %to, %from
  br label %check
check:
  %k = phi i64 [0, %start], [%after, %copy]
  %is_done = icmp eq i64 %k, %n
  br i1 %is_done, label %end, label %copy
copy:
  %after = add i64 %k, 1
  %from_end = sub i64 %n, %after
  %at = select i1 %is_above, i64 %from_end, i64 %k
  %source = getelementptr i8, ptr %from, i64 %at
  %target = getelementptr i8, ptr %to, i64 %at
  %byte = load volatile i8, ptr %source, align 1
  store volatile i8 %byte, ptr %target, align 1
  br label %check
end:
  ret ptr %to
}

define weak_odr hidden ptr @memcpy(ptr %to, ptr %from, i64 %n) nounwind "no-builtins" {
  %end = call ptr @memmove(ptr %to, ptr %from, i64 %n)
  ret ptr %end
}
"""

# numba's own: new strides of an array of another shape, here of one without gaps in the order of C
# only; 0: it has gaps.
_RESHAPE = """
define weak_odr hidden i32 @numba_attempt_nocopy_reshape(
    i64 %n, ptr %lengths, ptr %strides, i64 %new_n, ptr %new_lengths, ptr %new_strides,
    i64 %item, i32 %is_of_fortran) nounwind {
start:
  %is_first_last = icmp ne i32 %is_of_fortran, 0
  br i1 %is_first_last, label %gaps, label %check
check:
  %left = phi i64 [%n, %start], [%axis, %whole]
  %step = phi i64 [%item, %start], [%larger, %whole]
  %is_checked = icmp eq i64 %left, 0
  br i1 %is_checked, label %fill, label %look
look:
  %axis = sub i64 %left, 1
  %length_at = getelementptr i64, ptr %lengths, i64 %axis
  %stride_at = getelementptr i64, ptr %strides, i64 %axis
  %length = load i64, ptr %length_at
  %stride = load i64, ptr %stride_at
  %is_dense = icmp eq i64 %stride, %step
  %is_one = icmp eq i64 %length, 1
  %fits = or i1 %is_dense, %is_one
  %larger = mul i64 %step, %length
  br i1 %fits, label %whole, label %gaps
whole:
  br label %check
fill:
  %new_left = phi i64 [%new_n, %check], [%new_axis, %put]
  %new_step = phi i64 [%item, %check], [%new_larger, %put]
  %is_filled = icmp eq i64 %new_left, 0
  br i1 %is_filled, label %done, label %put
put:
  %new_axis = sub i64 %new_left, 1
  %new_stride_at = getelementptr i64, ptr %new_strides, i64 %new_axis
  store i64 %new_step, ptr %new_stride_at
  %new_length_at = getelementptr i64, ptr %new_lengths, i64 %new_axis
  %new_length = load i64, ptr %new_length_at
  %new_larger = mul i64 %new_step, %new_length
  br label %fill
done:
  ret i32 1
gaps:
  ret i32 0
}
"""

# Of an array that a kernel has allocated: none does, so nothing gets here.
_RELEASE = """
define weak_odr hidden i8 @isa_counted(ptr %count, i64 %by, i32 %condition) noreturn nounwind {
  call void @llvm.trap()
  unreachable
}

define weak_odr hidden void @NRT_MemInfo_call_dtor(ptr %array) noreturn nounwind {
  call void @llvm.trap()
  unreachable
}
"""

_DECLARED = """
declare void @llvm.trap()
declare double @llvm.fabs.f64(double)
declare double @llvm.copysign.f64(double, double)
declare i64 @llvm.ctlz.i64(i64, i1)
"""

RUNTIME = ''.join((_DECLARED, _FLOOR, _RINT, _FREXP, _FMOD, _MEMSET, _MEMMOVE, _RESHAPE, _RELEASE))
"""LLVM's text of all."""
