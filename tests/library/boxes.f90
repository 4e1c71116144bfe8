! The same as boxes.c through the Fortran module.
program boxes
  use teracell
  use, intrinsic :: iso_fortran_env, only: input_unit
  implicit none
  type(tc_grid) :: grid
  integer :: level, bytes, outside, status, out
  integer(int64) :: lo(3), hi(3)
  integer(int8), allocatable :: a(:, :, :)
  integer(int16), allocatable :: b(:, :, :)
  integer(int32), allocatable :: c(:, :, :)
  character(len=1000) :: path

  call get_command_argument(1, path)
  call grid%open(trim(path))
  open (newunit=out, file='/dev/stdout', access='stream', form='unformatted')
  do
    read (input_unit, *, iostat=status) level, bytes, outside, lo, hi
    if (status /= 0) exit
    select case (bytes)
    case (1)
      allocate (a(hi(1) - lo(1), hi(2) - lo(2), hi(3) - lo(3)))
      call grid%read(lo, a, level=level, outside=outside)
      write (out) a
      deallocate (a)
    case (2)
      allocate (b(hi(1) - lo(1), hi(2) - lo(2), hi(3) - lo(3)))
      call grid%read(lo, b, level=level, outside=outside)
      write (out) b
      deallocate (b)
    case (4)
      allocate (c(hi(1) - lo(1), hi(2) - lo(2), hi(3) - lo(3)))
      call grid%read(lo, c, level=level, outside=outside)
      write (out) c
      deallocate (c)
    end select
  end do
end program
