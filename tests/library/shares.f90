! The same as shares.cpp through the Fortran module.
program shares
  use teracell
  use, intrinsic :: iso_fortran_env, only: input_unit
  implicit none
  type(tc_grid) :: grid
  integer :: material, status, out
  integer(int64) :: lo(3), hi(3)
  real(real64), allocatable :: a(:, :, :)
  character(len=1000) :: path

  call get_command_argument(1, path)
  call grid%open(trim(path))
  open (newunit=out, file='/dev/stdout', access='stream', form='unformatted')
  do
    read (input_unit, *, iostat=status) material, lo, hi
    if (status /= 0) exit
    allocate (a(hi(1) - lo(1), hi(2) - lo(2), hi(3) - lo(3)))
    call grid%fractions(material, lo, a, outside=7.0_real64)
    write (out) a
    deallocate (a)
  end do
end program
